// SPDX-License-Identifier: Apache-2.0
#include "service/options/option_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace windhover::option_internal {
namespace {

template <typename T>
bool ParseWhole(std::string_view text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

template <typename T>
std::string ShortestText(T value) {
  std::array<char, 32> buffer;  // the longest double takes 24 characters
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

std::string Refusal(std::string_view name, std::string_view text) {
  return "option " + std::string(name) + ": '" + std::string(text) + "' is not ";
}

}  // namespace

bool ParseNumber(std::string_view text, double& value) {
  return ParseWhole(text, value) && std::isfinite(value);
}
bool ParseNumber(std::string_view text, std::int64_t& value) { return ParseWhole(text, value); }

std::string NumberText(double value) { return ShortestText(value); }
std::string NumberText(std::int64_t value) { return ShortestText(value); }

void RefuseNumber(std::string_view name, std::string_view text, std::string_view minimum,
                  std::string_view maximum, std::string_view unit) {
  std::string message =
      Refusal(name, text) + "a number from " + std::string(minimum) + " to " + std::string(maximum);
  if (!unit.empty()) message += " " + std::string(unit);
  throw OptionError(message);
}

void RefuseChoice(std::string_view name, std::string_view text,
                  std::span<const std::string_view> choices) {
  std::string message = Refusal(name, text) + "one of ";
  for (std::size_t index = 0; index < choices.size(); ++index) {
    if (index > 0) message += ", ";
    message += choices[index];
  }
  throw OptionError(message);
}

void RefuseName(std::string_view name) {
  throw OptionError("there is no option called '" + std::string(name) + "'");
}

}  // namespace windhover::option_internal
