// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glib-object.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "service/options/option.h"

// GObject properties made from option structs (service/options/option.h): one property for each
// field, of the field's name, default, range and meaning.

namespace windhover {
namespace option_properties_internal {

// "meaning (unit, minimum to maximum)", with the parts that there are.
std::string Blurb(std::string_view meaning, std::string_view unit, const std::string& minimum,
                  const std::string& maximum);
// "first-word" as "First word".
std::string Nick(std::string_view name);
// The enumeration "GstWindhover" + the name in camel case, registered on first use.
GType ChoiceType(std::string_view name, std::span<const std::string_view> names,
                 std::span<const std::string_view> meanings);

template <typename S, typename T>
GParamSpec* MakeSpec(const NumberField<S, T>& field, GParamFlags flags) {
  const S defaults;
  const std::string name(field.name);
  const std::string nick = Nick(field.name);
  S bounds;
  bounds.*field.member = field.minimum;
  const std::string minimum = OptionText(bounds, field.name);
  bounds.*field.member = field.maximum;
  const std::string maximum = OptionText(bounds, field.name);
  const std::string blurb = Blurb(field.meaning, field.unit, minimum, maximum);
  const auto make = [&](auto maker) {
    return maker(name.c_str(), nick.c_str(), blurb.c_str(), field.minimum, field.maximum,
                 defaults.*field.member, flags);
  };
  if constexpr (std::is_floating_point_v<T>) {
    return make(g_param_spec_double);
  } else if constexpr (sizeof(T) <= sizeof(int)) {
    return make(g_param_spec_int);
  } else {
    return make(g_param_spec_int64);
  }
}

template <typename S>
GParamSpec* MakeSpec(const FlagField<S>& field, GParamFlags flags) {
  return g_param_spec_boolean(std::string(field.name).c_str(), Nick(field.name).c_str(),
                              Blurb(field.meaning, "", "", "").c_str(), S{}.*field.member, flags);
}

template <typename S>
GParamSpec* MakeSpec(const TextField<S>& field, GParamFlags flags) {
  return g_param_spec_string(std::string(field.name).c_str(), Nick(field.name).c_str(),
                             Blurb(field.meaning, "", "", "").c_str(), (S{}.*field.member).c_str(),
                             flags);
}

template <typename S, typename E, std::size_t N>
GParamSpec* MakeSpec(const ChoiceField<S, E, N>& field, GParamFlags flags) {
  return g_param_spec_enum(std::string(field.name).c_str(), Nick(field.name).c_str(),
                           Blurb(field.meaning, "", "", "").c_str(),
                           ChoiceType(field.name, field.names, field.meanings),
                           static_cast<int>(S{}.*field.member), flags);
}

template <typename Field, typename S>
void SetField(const Field& field, S& options, const GValue* value) {
  using Value = typename Field::Value;
  auto& member = options.*field.member;
  if constexpr (std::is_same_v<Value, bool>) {
    member = g_value_get_boolean(value) != FALSE;
  } else if constexpr (std::is_same_v<Value, std::string>) {
    const char* text = g_value_get_string(value);
    member = text != nullptr ? text : "";
  } else if constexpr (std::is_enum_v<Value>) {
    member = static_cast<Value>(g_value_get_enum(value));
  } else if constexpr (std::is_floating_point_v<Value>) {
    member = static_cast<Value>(g_value_get_double(value));
  } else if constexpr (sizeof(Value) <= sizeof(int)) {
    member = static_cast<Value>(g_value_get_int(value));
  } else {
    member = static_cast<Value>(g_value_get_int64(value));
  }
}

template <typename Field, typename S>
void GetField(const Field& field, const S& options, GValue* value) {
  using Value = typename Field::Value;
  const auto& member = options.*field.member;
  if constexpr (std::is_same_v<Value, bool>) {
    g_value_set_boolean(value, member ? TRUE : FALSE);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    g_value_set_string(value, member.c_str());
  } else if constexpr (std::is_enum_v<Value>) {
    g_value_set_enum(value, static_cast<int>(member));
  } else if constexpr (std::is_floating_point_v<Value>) {
    g_value_set_double(value, member);
  } else if constexpr (sizeof(Value) <= sizeof(int)) {
    g_value_set_int(value, member);
  } else {
    g_value_set_int64(value, member);
  }
}

}  // namespace option_properties_internal

// The option structs of one element, as GObject properties. Property ids count from 1 in the order
// of the structs and their fields. Not thread-safe.
template <typename... Structs>
class OptionProperties {
 public:
  static constexpr guint kCount =
      (static_cast<guint>(std::tuple_size_v<decltype(Structs::Fields())>) + ... + 0u);

  // Installs a property for each option but those named in `without`; these keep their defaults.
  // `mutability` says when a change takes effect, e.g. GST_PARAM_MUTABLE_READY.
  static void Install(GObjectClass* klass, int mutability,
                      std::initializer_list<std::string_view> without = {}) {
    const auto flags = static_cast<GParamFlags>(G_PARAM_READWRITE | mutability);
    guint id = 0;
    (ForEachField<Structs>([&](const auto& field) {
       ++id;
       if (std::find(without.begin(), without.end(), field.name) != without.end()) return;
       g_object_class_install_property(klass, id,
                                       option_properties_internal::MakeSpec(field, flags));
     }),
     ...);
  }

  // False where no option has this id.
  bool Set(guint id, const GValue* value) {
    return Visit(*this, id, [&](const auto& field, auto& options) {
      option_properties_internal::SetField(field, options, value);
    });
  }
  bool Get(guint id, GValue* value) const {
    return Visit(*this, id, [&](const auto& field, const auto& options) {
      option_properties_internal::GetField(field, options, value);
    });
  }

  template <typename S>
  const S& get() const {
    return std::get<S>(options_);
  }

 private:
  template <typename Self, typename Action>
  static bool Visit(Self& self, guint id, Action&& action) {
    guint at = 0;
    bool found = false;
    (ForEachField<Structs>([&](const auto& field) {
       if (++at != id) return;
       action(field, std::get<Structs>(self.options_));
       found = true;
     }),
     ...);
    return found;
  }

  std::tuple<Structs...> options_;
};

}  // namespace windhover
