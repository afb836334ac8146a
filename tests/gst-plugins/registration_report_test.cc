// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/registration_report.h"

#include <gtest/gtest.h>

namespace windhover {
namespace {

constexpr auto kValid = RegistrationQuality::kValid;
constexpr auto kDegraded = RegistrationQuality::kDegraded;
constexpr auto kLost = RegistrationQuality::kLost;
constexpr GstClockTime kFrame = 40 * GST_MSECOND;

TEST(RegistrationReport, TellsAtOnceWhenLost) {
  RegistrationReport report;
  EXPECT_FALSE(report.Observe(kValid, 0).has_value());
  EXPECT_FALSE(report.Observe(kDegraded, kFrame).has_value());
  const auto news = report.Observe(kLost, 2 * kFrame);
  ASSERT_TRUE(news.has_value());
  EXPECT_TRUE(news->lost);
  EXPECT_EQ(news->changes_kept_back, 0);
  EXPECT_FALSE(report.Observe(kLost, 3 * kFrame).has_value());
}

TEST(RegistrationReport, FlickerIsToldOnceASecond) {
  RegistrationReport report;
  int told = 0;
  int changes = 0;
  for (int t = 0; t < 250; ++t) {  // 10 s
    const auto news = report.Observe(t % 2 == 0 ? kValid : kLost, t * kFrame);
    if (!news) continue;
    ++told;
    changes += 1 + news->changes_kept_back;
  }
  EXPECT_GE(told, 9);
  EXPECT_LE(told, 10);
  EXPECT_GT(changes, 200);
}

TEST(RegistrationReport, FoundAgainIsToldLater) {
  RegistrationReport report;
  EXPECT_TRUE(report.Observe(kLost, 0).has_value());
  EXPECT_FALSE(report.Observe(kValid, kFrame).has_value());
  EXPECT_FALSE(report.Observe(kValid, GST_SECOND - 1).has_value());
  const auto news = report.Observe(kValid, GST_SECOND);
  ASSERT_TRUE(news.has_value());
  EXPECT_FALSE(news->lost);
}

TEST(RegistrationReport, WithoutTimeStampsCountsFrames) {
  RegistrationReport report;
  EXPECT_TRUE(report.Observe(kLost, GST_CLOCK_TIME_NONE).has_value());
  for (int t = 0; t < 29; ++t) {
    EXPECT_FALSE(report.Observe(kValid, GST_CLOCK_TIME_NONE).has_value()) << t;
  }
  EXPECT_TRUE(report.Observe(kValid, GST_CLOCK_TIME_NONE).has_value());
}

}  // namespace
}  // namespace windhover
