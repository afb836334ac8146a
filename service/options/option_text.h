// SPDX-License-Identifier: Apache-2.0
#pragma once

// The definitions behind option.h, which includes this file. The text of one value is read and
// written here for each kind of field.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "service/options/option.h"

namespace windhover {
namespace option_internal {

// False where the text is not wholly a finite number of the type.
bool ParseNumber(std::string_view text, double& value);
bool ParseNumber(std::string_view text, std::int64_t& value);
std::string NumberText(double value);
std::string NumberText(std::int64_t value);

[[noreturn]] void RefuseNumber(std::string_view name, std::string_view text,
                               std::string_view minimum, std::string_view maximum,
                               std::string_view unit);
[[noreturn]] void RefuseChoice(std::string_view name, std::string_view text,
                               std::span<const std::string_view> choices);
[[noreturn]] void RefuseName(std::string_view name);

// Integers of all widths are read and written as 64 bits.
template <typename T>
using Wide = std::conditional_t<std::is_floating_point_v<T>, double, std::int64_t>;

template <typename S, typename T>
[[noreturn]] void Refuse(const NumberField<S, T>& field, std::string_view text) {
  RefuseNumber(field.name, text, NumberText(Wide<T>{field.minimum}),
               NumberText(Wide<T>{field.maximum}), field.unit);
}

template <typename S, typename T>
void Check(const NumberField<S, T>& field, const S& options) {
  const T value = options.*field.member;
  // Written so that NaN is refused.
  const bool in_range = value >= field.minimum && value <= field.maximum;
  if (!in_range) Refuse(field, NumberText(Wide<T>{value}));
}
template <typename S>
void Check(const FlagField<S>&, const S&) {}
template <typename S>
void Check(const TextField<S>&, const S&) {}
template <typename S, typename E, std::size_t N>
void Check(const ChoiceField<S, E, N>& field, const S& options) {
  const auto index = static_cast<std::int64_t>(options.*field.member);
  if (index < 0 || index >= static_cast<std::int64_t>(N)) {
    RefuseChoice(field.name, NumberText(index), field.names);
  }
}

template <typename S, typename T>
void Set(const NumberField<S, T>& field, S& options, std::string_view text) {
  Wide<T> value{};
  const bool in_range = ParseNumber(text, value) && value >= Wide<T>{field.minimum} &&
                        value <= Wide<T>{field.maximum};
  if (!in_range) Refuse(field, text);
  options.*field.member = static_cast<T>(value);
}
template <typename S>
void Set(const FlagField<S>& field, S& options, std::string_view text) {
  static constexpr std::string_view kChoices[] = {"true", "false"};
  if (text != "true" && text != "false") RefuseChoice(field.name, text, kChoices);
  options.*field.member = text == "true";
}
template <typename S>
void Set(const TextField<S>& field, S& options, std::string_view text) {
  options.*field.member = text;
}
template <typename S, typename E, std::size_t N>
void Set(const ChoiceField<S, E, N>& field, S& options, std::string_view text) {
  for (std::size_t index = 0; index < N; ++index) {
    if (field.names[index] == text) {
      options.*field.member = static_cast<E>(index);
      return;
    }
  }
  RefuseChoice(field.name, text, field.names);
}

template <typename S, typename T>
std::string ValueText(const NumberField<S, T>& field, const S& options) {
  return NumberText(Wide<T>{options.*field.member});
}
template <typename S>
std::string ValueText(const FlagField<S>& field, const S& options) {
  return options.*field.member ? "true" : "false";
}
template <typename S>
std::string ValueText(const TextField<S>& field, const S& options) {
  return options.*field.member;
}
template <typename S, typename E, std::size_t N>
std::string ValueText(const ChoiceField<S, E, N>& field, const S& options) {
  Check(field, options);
  return std::string(field.names[static_cast<std::size_t>(options.*field.member)]);
}

}  // namespace option_internal

template <typename S>
void CheckOptions(const S& options) {
  ForEachField<S>([&](const auto& field) { option_internal::Check(field, options); });
}

template <typename S>
bool SetOption(S& options, std::string_view name, std::string_view text) {
  bool found = false;
  ForEachField<S>([&](const auto& field) {
    if (found || field.name != name) return;
    option_internal::Set(field, options, text);
    found = true;
  });
  return found;
}

template <typename S>
std::string OptionText(const S& options, std::string_view name) {
  std::string text;
  bool found = false;
  ForEachField<S>([&](const auto& field) {
    if (found || field.name != name) return;
    text = option_internal::ValueText(field, options);
    found = true;
  });
  if (!found) option_internal::RefuseName(name);
  return text;
}

}  // namespace windhover
