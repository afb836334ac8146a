// SPDX-License-Identifier: Apache-2.0
#include "service/options/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "service/options/feature_options.h"
#include "service/options/overlay_options.h"
#include "service/options/publish_options.h"
#include "service/options/stabilisation_options.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;

using AllOptions =
    std::tuple<DeviceOptions, RegistrationOptions, FeatureRegistrationOptions, BackgroundOptions,
               MotionOptions, PublishOptions, OverlayOptions, StabilisationOptions>;

template <typename Visit>
void ForEachStruct(Visit&& visit) {
  std::apply([&](const auto&... options) { (visit(options), ...); }, AllOptions());
}

// The error's text, or "" where `set` throws none.
template <typename Function>
std::string RefusalOf(Function&& set) {
  try {
    set();
  } catch (const OptionError& error) {
    return error.what();
  }
  return "";
}

struct Odd {
  enum class Colour { kRed, kGreen };
  int count = 3;
  double ratio = 0.25;
  bool loud = false;
  std::string label = "a";
  Colour colour = Colour::kGreen;

  static constexpr auto Fields() {
    return std::make_tuple(
        Number("count", &Odd::count, -5, 5, "frames", "Count"),
        Number("ratio", &Odd::ratio, 0.0, 1e6, "px", "Ratio"), Flag("loud", &Odd::loud, "Loud"),
        Text("label", &Odd::label, "Label"),
        Choice("colour", &Odd::colour, std::array<std::string_view, 2>{"red", "green"},
               std::array<std::string_view, 2>{"like blood", "like grass"}, "Colour"));
  }
};

bool IsKebabCase(std::string_view name) {
  if (name.empty() || std::islower(static_cast<unsigned char>(name.front())) == 0) return false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    const bool dash = c == '-' && i + 1 < name.size() && name[i + 1] != '-';
    if (std::islower(c) == 0 && std::isdigit(c) == 0 && !dash) return false;
  }
  return true;
}

// A second value of each kind of field, other than the default where there is one.
template <typename S, typename T>
std::vector<std::string> SomeTexts(const NumberField<S, T>& field) {
  using option_internal::NumberText;
  using Wide = option_internal::Wide<T>;
  return {NumberText(Wide{field.minimum}), NumberText(Wide{field.maximum}),
          NumberText(Wide{static_cast<T>((field.minimum + field.maximum) / 3)})};
}
template <typename S>
std::vector<std::string> SomeTexts(const FlagField<S>&) {
  return {"true", "false"};
}
template <typename S>
std::vector<std::string> SomeTexts(const TextField<S>&) {
  return {"", "two words = one"};
}
template <typename S, typename E, std::size_t N>
std::vector<std::string> SomeTexts(const ChoiceField<S, E, N>& field) {
  return {field.names.begin(), field.names.end()};
}

TEST(AllOptions, DefaultsAreInRange) {
  ForEachStruct(
      [](const auto& options) { EXPECT_EQ(RefusalOf([&] { CheckOptions(options); }), ""); });
}

// One --set key and one line of help must mean one thing over the whole program.
TEST(AllOptions, NamesAreUniqueAndKebabCase) {
  std::set<std::string_view> names;
  ForEachStruct([&](const auto& options) {
    ForEachField<std::decay_t<decltype(options)>>([&](const auto& field) {
      EXPECT_TRUE(IsKebabCase(field.name)) << field.name;
      EXPECT_TRUE(names.insert(field.name).second) << field.name << " is there twice";
    });
  });
  EXPECT_GT(names.size(), 20U);
}

TEST(AllOptions, HaveAMeaning) {
  ForEachStruct([](const auto& options) {
    ForEachField<std::decay_t<decltype(options)>>([](const auto& field) {
      EXPECT_GE(field.meaning.size(), 10U) << field.name;
      EXPECT_NE(field.meaning.back(), '.') << field.name;
    });
  });
}

TEST(AllOptions, TextRoundTrips) {
  ForEachStruct([](const auto& defaults) {
    using S = std::decay_t<decltype(defaults)>;
    ForEachField<S>([&](const auto& field) {
      std::vector<std::string> texts = SomeTexts(field);
      texts.push_back(OptionText(defaults, field.name));
      for (const std::string& text : texts) {
        S options = defaults;
        ASSERT_TRUE(SetOption(options, field.name, text)) << field.name;
        EXPECT_EQ(OptionText(options, field.name), text) << field.name;
        EXPECT_EQ(RefusalOf([&] { CheckOptions(options); }), "");
      }
    });
  });
}

TEST(AllOptions, SetOneLeavesTheOthers) {
  ForEachStruct([](const auto& defaults) {
    using S = std::decay_t<decltype(defaults)>;
    ForEachField<S>([&](const auto& field) {
      S options = defaults;
      SetOption(options, field.name, SomeTexts(field).front());
      ForEachField<S>([&](const auto& other) {
        if (other.name == field.name) return;
        EXPECT_EQ(OptionText(options, other.name), OptionText(defaults, other.name))
            << field.name << " changed " << other.name;
      });
    });
  });
}

template <typename S, typename T>
void ExpectRangeIsKept(const NumberField<S, T>& field) {
  using option_internal::NumberText;
  using Wide = option_internal::Wide<T>;
  const double step = std::is_integral_v<T> ? 1.0 : 1e-3;
  for (const double outside : {field.minimum - step, field.maximum + step}) {
    S options;
    const std::string before = OptionText(options, field.name);
    const std::string text = NumberText(static_cast<Wide>(outside));
    const std::string refusal = RefusalOf([&] { SetOption(options, field.name, text); });
    EXPECT_THAT(refusal, HasSubstr("option " + std::string(field.name) + ":"));
    EXPECT_THAT(refusal, HasSubstr("'" + text + "'"));
    EXPECT_THAT(refusal, HasSubstr(NumberText(Wide{field.minimum}) + " to " +
                                   NumberText(Wide{field.maximum})));
    EXPECT_THAT(refusal, HasSubstr(std::string(field.unit)));
    EXPECT_EQ(OptionText(options, field.name), before);

    options.*field.member = static_cast<T>(outside);
    EXPECT_THAT(RefusalOf([&] { CheckOptions(options); }), HasSubstr(std::string(field.name)));
  }
}
template <typename S, typename E, std::size_t N>
void ExpectRangeIsKept(const ChoiceField<S, E, N>& field) {
  S options;
  const std::string refusal = RefusalOf([&] { SetOption(options, field.name, "no-such-choice"); });
  EXPECT_THAT(refusal, HasSubstr("option " + std::string(field.name) + ": 'no-such-choice'"));
  for (const std::string_view choice : field.names) {
    EXPECT_THAT(refusal, HasSubstr(std::string(choice)));
  }
  options.*field.member = static_cast<E>(N);
  EXPECT_THAT(RefusalOf([&] { CheckOptions(options); }), HasSubstr(std::string(field.name)));
}
template <typename S>
void ExpectRangeIsKept(const FlagField<S>& field) {
  S options;
  const std::string refusal = RefusalOf([&] { SetOption(options, field.name, "1"); });
  EXPECT_THAT(refusal, HasSubstr("option " + std::string(field.name) + ": '1'"));
  EXPECT_THAT(refusal, HasSubstr("true, false"));
}
template <typename S>
void ExpectRangeIsKept(const TextField<S>&) {}

TEST(AllOptions, RefuseWhatIsOutOfRange) {
  ForEachStruct([](const auto& options) {
    ForEachField<std::decay_t<decltype(options)>>(
        [](const auto& field) { ExpectRangeIsKept(field); });
  });
  ForEachField<Odd>([](const auto& field) { ExpectRangeIsKept(field); });
}

TEST(Option, RefusalIsOneSentence) {
  Odd odd;
  EXPECT_EQ(RefusalOf([&] { SetOption(odd, "count", "6"); }),
            "option count: '6' is not a number from -5 to 5 frames");
  EXPECT_EQ(RefusalOf([&] { SetOption(odd, "colour", "Red"); }),
            "option colour: 'Red' is not one of red, green");
}

TEST(Option, TextMustBeANumberToItsEnd) {
  for (const char* text :
       {"", " ", "1 ", " 1", "+1", "1x", "0x1", "1,5", "one", "--1", "1.0", "1e0"}) {
    Odd odd;
    EXPECT_NE(RefusalOf([&] { SetOption(odd, "count", text); }), "") << "'" << text << "'";
    EXPECT_EQ(odd.count, 3);
  }
  for (const char* text : {"", ".", "1 ", "1,5", "1.5px", "e5", "0x1p3"}) {
    Odd odd;
    EXPECT_NE(RefusalOf([&] { SetOption(odd, "ratio", text); }), "") << "'" << text << "'";
    EXPECT_EQ(odd.ratio, 0.25);
  }
  Odd odd;
  SetOption(odd, "ratio", "1.25e3");
  EXPECT_EQ(odd.ratio, 1250.0);
  SetOption(odd, "count", "-5");
  EXPECT_EQ(odd.count, -5);
}

TEST(Option, NumbersTooLongForTheTypeAreRefused) {
  Odd odd;
  EXPECT_NE(RefusalOf([&] { SetOption(odd, "count", "4294967299"); }), "");
  EXPECT_NE(RefusalOf([&] { SetOption(odd, "count", "99999999999999999999"); }), "");
  EXPECT_NE(RefusalOf([&] { SetOption(odd, "ratio", "1e999"); }), "");
  EXPECT_EQ(odd.count, 3);
  EXPECT_EQ(odd.ratio, 0.25);
}

TEST(Option, NanAndInfinityAreRefused) {
  for (const char* text : {"nan", "NaN", "-nan", "inf", "-inf", "infinity"}) {
    Odd odd;
    EXPECT_NE(RefusalOf([&] { SetOption(odd, "ratio", text); }), "") << text;
  }
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Odd odd;
    odd.ratio = value;
    EXPECT_THAT(RefusalOf([&] { CheckOptions(odd); }), HasSubstr("option ratio"));
  }
}

TEST(Option, ShortestTextGivesTheValueBack) {
  Odd odd;
  for (const double value : {0.1, 1.0 / 3.0, 123456.789, 1e-7, 5e-324}) {
    odd.ratio = value;
    Odd copy;
    ASSERT_TRUE(SetOption(copy, "ratio", OptionText(odd, "ratio")));
    EXPECT_EQ(copy.ratio, value);
  }
  odd.ratio = 0.1;
  EXPECT_EQ(OptionText(odd, "ratio"), "0.1");
}

TEST(Option, LocaleDoesNotMatter) {
  // Streams with a comma for a decimal point. C's own locale cannot be made here without a system's
  // locale files; nothing of it is called.
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  Odd odd;
  EXPECT_TRUE(SetOption(odd, "ratio", "2.5"));
  EXPECT_EQ(odd.ratio, 2.5);
  EXPECT_EQ(OptionText(odd, "ratio"), "2.5");
  std::locale::global(before);
}

TEST(Option, UnknownNameIsNoOption) {
  Odd odd;
  EXPECT_FALSE(SetOption(odd, "Count", "1"));
  EXPECT_FALSE(SetOption(odd, "", "1"));
  EXPECT_EQ(odd.count, 3);
  EXPECT_THAT(RefusalOf([&] { OptionText(odd, "no-such-option"); }), HasSubstr("no-such-option"));
}

}  // namespace
}  // namespace windhover
