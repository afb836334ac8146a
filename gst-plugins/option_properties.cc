// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/option_properties.h"

#include <cctype>

namespace windhover::option_properties_internal {

std::string Blurb(std::string_view meaning, std::string_view unit, const std::string& minimum,
                  const std::string& maximum) {
  std::string blurb(meaning);
  std::string range;
  if (!minimum.empty()) range = minimum + " to " + maximum;
  if (unit.empty() && range.empty()) return blurb;
  blurb += " (";
  blurb += unit;
  if (!unit.empty() && !range.empty()) blurb += ", ";
  return blurb + range + ")";
}

std::string Nick(std::string_view name) {
  std::string nick(name);
  std::replace(nick.begin(), nick.end(), '-', ' ');
  if (!nick.empty()) nick[0] = static_cast<char>(std::toupper(nick[0]));
  return nick;
}

GType ChoiceType(std::string_view name, std::span<const std::string_view> names,
                 std::span<const std::string_view> meanings) {
  std::string type_name = "GstWindhover";
  bool starts_word = true;
  for (const char c : name) {
    if (c != '-') type_name += starts_word ? static_cast<char>(std::toupper(c)) : c;
    starts_word = c == '-';
  }
  if (const GType known = g_type_from_name(type_name.c_str())) return known;

  // GObject keeps the array and its texts for the life of the process.
  auto* values = g_new0(GEnumValue, names.size() + 1);
  for (std::size_t i = 0; i < names.size(); ++i) {
    values[i].value = static_cast<int>(i);
    values[i].value_name = g_strndup(meanings[i].data(), meanings[i].size());
    values[i].value_nick = g_strndup(names[i].data(), names[i].size());
  }
  return g_enum_register_static(type_name.c_str(), values);
}

}  // namespace windhover::option_properties_internal
