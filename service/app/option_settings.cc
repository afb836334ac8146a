// SPDX-License-Identifier: Apache-2.0
#include "service/app/option_settings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>

#include "service/options/options.h"
#include "service/options/overlay_options.h"
#include "service/options/publish_options.h"

namespace windhover {
namespace {

using AllOptions = std::tuple<DeviceOptions, RegistrationOptions, BackgroundOptions, MotionOptions,
                              PublishOptions, OverlayOptions>;

template <typename S, typename T>
std::string Range(const NumberField<S, T>& field) {
  return fmt::format("{} to {}{}{}", field.minimum, field.maximum, field.unit.empty() ? "" : " ",
                     field.unit);
}
template <typename S>
std::string Range(const FlagField<S>&) {
  return "true or false";
}
template <typename S>
std::string Range(const TextField<S>&) {
  return "text";
}
template <typename S, typename E, std::size_t N>
std::string Range(const ChoiceField<S, E, N>& field) {
  return fmt::format("{}", fmt::join(field.names, " or "));
}

// Calls visit(options, field) for each option of the structs of a tuple.
template <typename Structs, typename Visit>
void ForEachOption(Visit visit) {
  std::apply(
      [&](const auto&... options) {
        const auto visit_struct = [&](const auto& one) {
          ForEachField<std::decay_t<decltype(one)>>([&](const auto& field) { visit(one, field); });
        };
        (visit_struct(options), ...);
      },
      Structs());
}

template <typename Structs>
std::string Names() {
  std::vector<std::string_view> names;
  ForEachOption<Structs>([&](const auto&, const auto& field) { names.push_back(field.name); });
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

template <typename Structs>
std::string Describe() {
  std::string text;
  ForEachOption<Structs>([&](const auto& options, const auto& field) {
    text += fmt::format("  {}={}  ({})\n      {}\n", field.name, OptionText(options, field.name),
                        Range(field), field.meaning);
  });
  return text;
}

OptionSetting Split(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw OptionError("'" + text + "' is not of the form option=value");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

template <typename Structs>
[[noreturn]] void ThrowUnknown(const std::string& name) {
  throw OptionError("No option is called '" + name + "'. There are: " + Names<Structs>());
}

}  // namespace

OptionSetting ParseOptionSetting(const std::string& text) {
  OptionSetting setting = Split(text);
  AllOptions all;
  const bool known = std::apply(
      [&](auto&... options) {
        // Not short-circuited: several structs may have an option of that name.
        return (static_cast<int>(SetOption(options, setting.name, setting.value)) + ...) > 0;
      },
      all);
  if (!known) ThrowUnknown<AllOptions>(setting.name);
  return setting;
}

void SetRegistrationOption(const std::string& text, RegistrationOptions& options) {
  const OptionSetting setting = Split(text);
  if (!SetOption(options, setting.name, setting.value)) {
    ThrowUnknown<std::tuple<RegistrationOptions>>(setting.name);
  }
}

std::string DescribeOptions() { return Describe<AllOptions>(); }

std::string DescribeRegistrationOptions() { return Describe<std::tuple<RegistrationOptions>>(); }

}  // namespace windhover
