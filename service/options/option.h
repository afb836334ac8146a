// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace windhover {

// An option is one member of one struct plus one entry in that struct's Fields() tuple. From that
// one description come the GObject property, the --set key, the --help line and the documentation
// row.
//
//   struct ExampleOptions {
//     int tiles = 36;  // the default
//     static constexpr auto Fields() {
//       return std::make_tuple(
//           Number("tiles", &ExampleOptions::tiles, 4, 100, "", "Tiles over the picture"));
//     }
//   };

// A number with an inclusive range. `unit` is "" for counts and ratios.
template <typename S, typename T>
struct NumberField {
  using Struct = S;
  using Value = T;
  std::string_view name;
  T S::*member;
  T minimum;
  T maximum;
  std::string_view unit;
  std::string_view meaning;
};

template <typename S>
struct FlagField {
  using Struct = S;
  using Value = bool;
  std::string_view name;
  bool S::*member;
  std::string_view meaning;
};

template <typename S>
struct TextField {
  using Struct = S;
  using Value = std::string;
  std::string_view name;
  std::string S::*member;
  std::string_view meaning;
};

// An enumeration whose values count from 0 in the order of `names`.
template <typename S, typename E, std::size_t N>
struct ChoiceField {
  using Struct = S;
  using Value = E;
  std::string_view name;
  E S::*member;
  std::array<std::string_view, N> names;     // as users write them
  std::array<std::string_view, N> meanings;  // one line each
  std::string_view meaning;
};

template <typename S, typename T>
constexpr auto Number(std::string_view name, T S::*member, std::type_identity_t<T> minimum,
                      std::type_identity_t<T> maximum, std::string_view unit,
                      std::string_view meaning) {
  return NumberField<S, T>{name, member, minimum, maximum, unit, meaning};
}
template <typename S>
constexpr auto Flag(std::string_view name, bool S::*member, std::string_view meaning) {
  return FlagField<S>{name, member, meaning};
}
template <typename S>
constexpr auto Text(std::string_view name, std::string S::*member, std::string_view meaning) {
  return TextField<S>{name, member, meaning};
}
template <typename S, typename E, std::size_t N>
constexpr auto Choice(std::string_view name, E S::*member,
                      const std::array<std::string_view, N>& names,
                      const std::array<std::string_view, N>& meanings, std::string_view meaning) {
  return ChoiceField<S, E, N>{name, member, names, meanings, meaning};
}

// Calls visit(field) for each option of S, in order.
template <typename S, typename Visit>
constexpr void ForEachField(Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, S::Fields());
}

// A value that an option cannot take. The text names the option, the value and what would be right:
// the allowed range with its unit, or the choices.
class OptionError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

// Throws OptionError for the first number that is not finite or out of range and for the first
// choice that is none.
template <typename S>
void CheckOptions(const S& options);

// Sets the option called `name` from text. Returns false, leaving all as it is, where S has no
// option of that name; throws OptionError, leaving all as it is, where the text is not wholly a
// value that the option can take. Numbers are written as in C whatever the locale, without sign '+'
// or spaces; flags are "true" or "false"; choices are their names.
template <typename S>
bool SetOption(S& options, std::string_view name, std::string_view text);

// The value in the form that SetOption takes; numbers are the shortest text that gives them back
// exactly. Throws OptionError where S has no option of that name.
template <typename S>
std::string OptionText(const S& options, std::string_view name);

}  // namespace windhover

#include "service/options/option_text.h"  // IWYU pragma: keep
