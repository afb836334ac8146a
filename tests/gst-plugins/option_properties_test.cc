// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/option_properties.h"

#include <gmock/gmock.h>
#include <gst/gst.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "service/options/options.h"
#include "service/options/overlay_options.h"
#include "service/options/publish_options.h"
#include "service/options/stabilisation_options.h"
#include "tests/gst-plugins/harness.h"

namespace windhover {
namespace {

// The value of a property as SetOption would take it.
std::string PropertyText(GstElement* element, const std::string& name) {
  GValue value = G_VALUE_INIT;
  g_object_get_property(G_OBJECT(element), name.c_str(), &value);
  std::string text;
  if (G_VALUE_HOLDS_STRING(&value)) {
    text = g_value_get_string(&value);
  } else if (G_VALUE_HOLDS_DOUBLE(&value)) {
    RegistrationOptions scratch;
    scratch.min_overlap = g_value_get_double(&value);
    text = option_internal::NumberText(scratch.min_overlap);
  } else {
    gchar* serialised = gst_value_serialize(&value);
    text = serialised;
    g_free(serialised);
  }
  g_value_unset(&value);
  return text;
}

// Texts that one option should come through unchanged: its least and its greatest value, or each
// of its choices.
template <typename S, typename T>
std::vector<std::string> Samples(const NumberField<S, T>& field) {
  return {option_internal::NumberText(option_internal::Wide<T>{field.minimum}),
          option_internal::NumberText(option_internal::Wide<T>{field.maximum})};
}
template <typename S>
std::vector<std::string> Samples(const FlagField<S>&) {
  return {"true", "false"};
}
template <typename S>
std::vector<std::string> Samples(const TextField<S>&) {
  return {"words of any kind", ""};
}
template <typename S, typename E, std::size_t N>
std::vector<std::string> Samples(const ChoiceField<S, E, N>& field) {
  return {field.names.begin(), field.names.end()};
}

template <typename S>
void ExpectProperties(const char* element_name, const std::vector<std::string>& without = {}) {
  const ElementPtr owned = MakeElement(element_name);
  GstElement* element = owned.get();
  ForEachField<S>([&](const auto& field) {
    SCOPED_TRACE(std::string(element_name) + " " + std::string(field.name));
    const std::string name(field.name);
    GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name.c_str());
    if (std::count(without.begin(), without.end(), name) != 0) {
      EXPECT_EQ(spec, nullptr);
      return;
    }
    ASSERT_NE(spec, nullptr);
    EXPECT_THAT(g_param_spec_get_blurb(spec), testing::HasSubstr(std::string(field.meaning)));
    EXPECT_NE(spec->flags & GST_PARAM_MUTABLE_READY, 0);
    EXPECT_EQ(PropertyText(element, name), OptionText(S{}, name)) << "default";
    for (const std::string& sample : Samples(field)) {
      gst_util_set_object_arg(G_OBJECT(element), name.c_str(), sample.c_str());
      EXPECT_EQ(PropertyText(element, name), sample);
    }
  });
}

TEST(OptionProperties, EveryFieldIsAProperty) {
  ExpectProperties<RegistrationOptions>("whregister");
  ExpectProperties<DeviceOptions>("whregister");
  ExpectProperties<BackgroundOptions>("whbackground");
  ExpectProperties<DeviceOptions>("whbackground");
  ExpectProperties<RegistrationOptions>("whbackground", {"reference"});
  ExpectProperties<MotionOptions>("whmotion");
  ExpectProperties<PublishOptions>("whpublish");
  ExpectProperties<OverlayOptions>("whoverlay");
  ExpectProperties<StabilisationOptions>("whstabilize");
}

TEST(OptionProperties, BlurbTellsUnitAndRange) {
  const ElementPtr element = MakeElement("whmotion");
  GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element.get()), "max-speed");
  EXPECT_THAT(g_param_spec_get_blurb(spec), testing::HasSubstr("(px/frame, 0.1 to 50)"));
  EXPECT_STREQ(g_param_spec_get_nick(spec), "Max speed");
}

// GObject keeps values out of range away from the element, and warns.
TEST(OptionProperties, RangeHolds) {
  const ElementPtr element = MakeElement("whbackground");
  GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element.get()), "threshold");
  const BackgroundOptions defaults;
  EXPECT_EQ(G_PARAM_SPEC_INT(spec)->minimum, 1);
  EXPECT_EQ(G_PARAM_SPEC_INT(spec)->maximum, 255);
  EXPECT_EQ(G_PARAM_SPEC_INT(spec)->default_value, defaults.threshold);

  int warnings = 0;
  const guint handler = g_log_set_handler(
      "GLib-GObject", G_LOG_LEVEL_WARNING,
      [](const gchar*, GLogLevelFlags, const gchar*, gpointer count) {
        ++*static_cast<int*>(count);
      },
      &warnings);
  g_object_set(element.get(), "threshold", 17, nullptr);
  for (const int wrong : {0, 256}) g_object_set(element.get(), "threshold", wrong, nullptr);
  g_log_remove_handler("GLib-GObject", handler);
  EXPECT_EQ(PropertyText(element.get(), "threshold"), "17");
  EXPECT_EQ(warnings, 2);
}

TEST(OptionProperties, UnknownIdIsRefused) {
  OptionProperties<DeviceOptions> properties;
  GValue value = G_VALUE_INIT;
  g_value_init(&value, G_TYPE_STRING);
  EXPECT_TRUE(properties.Get(1, &value));
  EXPECT_FALSE(properties.Get(0, &value));
  EXPECT_FALSE(properties.Get(2, &value));
  EXPECT_FALSE(properties.Set(2, &value));
  g_value_unset(&value);
}

}  // namespace
}  // namespace windhover
