// SPDX-License-Identifier: Apache-2.0
// Prints README.md of this folder: every option, from the descriptions that the program itself
// uses.
#include <iostream>
#include <sstream>

#include "service/options/feature_options.h"
#include "service/options/options.h"
#include "service/options/overlay_options.h"
#include "service/options/publish_options.h"
#include "service/options/stabilisation_options.h"

namespace windhover {
namespace {

constexpr std::string_view kHead =
    R"(<!-- Printed by print_options.cc: change the structs there and run `ninja options_readme`. -->
# Options

Each option is one member of one struct in this folder. It is a property of the elements named below
(`gst-inspect-1.0 whregister` shows them, too) and a key of `windhover run --set`:

    gst-launch-1.0 ... ! whregister tile-columns=8 ! ...
    windhover run flight.mp4 --set tile-columns=8 --set reference=centre

Numbers are written with a decimal point whatever the locale; ranges are inclusive.
)";

template <typename S, typename T>
std::string Allowed(const NumberField<S, T>& field) {
  using option_internal::NumberText;
  using option_internal::Wide;
  return NumberText(Wide<T>{field.minimum}) + " to " + NumberText(Wide<T>{field.maximum});
}
template <typename S>
std::string Allowed(const FlagField<S>&) {
  return "true, false";
}
template <typename S>
std::string Allowed(const TextField<S>&) {
  return "text";
}
template <typename S, typename E, std::size_t N>
std::string Allowed(const ChoiceField<S, E, N>& field) {
  std::string allowed;
  for (const std::string_view name : field.names) {
    if (!allowed.empty()) allowed += ", ";
    allowed += name;
  }
  return allowed;
}

template <typename Field>
std::string_view Unit(const Field& field) {
  if constexpr (requires { field.unit; }) return field.unit;
  return "";
}

template <typename Field>
std::string Meaning(const Field& field) {
  std::string meaning(field.meaning);
  if constexpr (requires { field.meanings; }) {
    for (std::size_t i = 0; i < field.names.size(); ++i) {
      meaning += (i == 0 ? ": `" : "; `") + std::string(field.names[i]) + "`: ";
      meaning += field.meanings[i];
    }
  }
  return meaning;
}

// Text as Markdown takes it in a table: '|' would end the cell and '<' begin a tag.
std::string Cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|' || c == '<') cell += '\\';
    cell += c;
  }
  return cell;
}

template <typename S>
void PrintTable(std::string_view title, std::string_view users) {
  std::cout << "\n## " << title << "\n\n"
            << users << "\n\n| name | default | values | unit | meaning |\n|---|---|---|---|---|\n";
  const S defaults;
  ForEachField<S>([&](const auto& field) {
    const std::string value = OptionText(defaults, field.name);
    std::cout << "| `" << field.name << "` | " << (value.empty() ? "" : "`" + value + "`") << " | "
              << Allowed(field) << " | " << Cell(Unit(field)) << " | " << Cell(Meaning(field))
              << " |\n";
  });
}

}  // namespace
}  // namespace windhover

int main() {
  using namespace windhover;  // NOLINT(google-build-using-namespace): names of this file only
  std::cout << kHead;
  PrintTable<DeviceOptions>("Device", "Of `whregister` and `whbackground`.");
  PrintTable<RegistrationOptions>(
      "Registration",
      "Of `whregister`; of `whbackground`, too, which registers in `reference=centre`.");
  PrintTable<FeatureRegistrationOptions>(
      "Registration by features",
      "Of `FeatureRegistration` in `service/vision`, for programs: no element has them.");
  PrintTable<BackgroundOptions>("Background", "Of `whbackground`.");
  PrintTable<MotionOptions>("Motion", "Of `whmotion`.");
  PrintTable<PublishOptions>("Publishing", "Of `whpublish`.");
  PrintTable<OverlayOptions>("Overlay", "Of `whoverlay`.");
  PrintTable<StabilisationOptions>(
      "Stabilisation", "Of `whstabilize`, which `windhover run` does without: no keys of `--set`.");
  return 0;
}
