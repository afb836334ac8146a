// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "replay/baselines/klt_registration.h"
#include "replay/benchmarks/timing.h"
#include "replay/offline/detection.h"
#include "replay/offline/overlay.h"
#include "replay/render/renderer.h"
#include "replay/scoring/registration_score.h"
#include "service/options/option.h"

namespace windhover::replay {
namespace {

constexpr int kFrames = 30;

struct SmallFlight {
  std::vector<cv::Mat> frames;
  std::vector<Eigen::Matrix3d> first_from_frame;
};

const SmallFlight& TheSmallFlight() {
  static const SmallFlight flight = [] {
    FlightPlan plan = FindFlightPlan("flight");
    plan.width = 320;
    plan.height = 240;
    plan.frames = kFrames;
    const Renderer renderer(plan, 2);
    SmallFlight made;
    for (int i = 0; i < kFrames; ++i) {
      made.frames.push_back(renderer.Frame(i));
      made.first_from_frame.push_back(renderer.TrueHomography(i));
    }
    return made;
  }();
  return flight;
}

TEST(PipelineOption, IsCheckedAgainstTheElements) {
  EXPECT_EQ(ParsePipelineOption("reference=centre"), PipelineOption("reference", "centre"));
  EXPECT_EQ(ParsePipelineOption("device=a:b=c"), PipelineOption("device", "a:b=c"));
  for (const char* known : {"k=7", "threshold=31", "min-area=5", "trails=false"}) {
    EXPECT_NO_THROW(ParsePipelineOption(known)) << known;
  }
  // Nothing is published here.
  for (const char* wrong : {"k", "k=many", "no-such-option=1", "stream=alpha"}) {
    EXPECT_THROW(ParsePipelineOption(wrong), OptionError) << wrong;
  }
}

TEST(KltRegistration, FollowsTheFlightFromTheSecondFrameOn) {
  KltRegistration klt;
  std::vector<Eigen::Matrix3d> composed;
  for (const cv::Mat& frame : TheSmallFlight().frames) {
    cv::Mat gray;
    cv::cvtColor(frame, gray, cv::COLOR_BGR2GRAY);
    const std::optional<Eigen::Matrix3d> previous_from_frame = klt.Register(gray);
    ASSERT_EQ(previous_from_frame.has_value(), !composed.empty());
    composed.push_back(composed.empty() ? Eigen::Matrix3d::Identity()
                                        : Eigen::Matrix3d(composed.back() * *previous_from_frame));
  }
  const RegistrationScore score =
      ScoreRegistration(composed, TheSmallFlight().first_from_frame, 320, 240);
  EXPECT_LT(score.max_px.value(), 0.3);
}

TEST(KltRegistration, FlatPicturesGiveNothing) {
  KltRegistration klt;
  const cv::Mat flat(240, 320, CV_8UC1, cv::Scalar(90));
  klt.Register(flat);
  EXPECT_FALSE(klt.Register(flat).has_value());
}

TEST(Quantile, IsTheNearestRank) {
  EXPECT_EQ(Quantile({}, 0.5), 0);
  EXPECT_EQ(Quantile({3}, 0.95), 3);
  EXPECT_EQ(Quantile({4, 1, 3, 2}, 0.5), 2);
  EXPECT_EQ(Quantile({4, 1, 3, 2}, 0.95), 4);
  EXPECT_EQ(Quantile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(Quantile({5, 1, 4, 2, 3}, 0), 1);
}

TEST(Overlay, ColoursSayHitFalseAlarmAndMiss) {
  cv::Mat frame(100, 100, CV_8UC3, cv::Scalar(0, 0, 0));
  const std::vector<LabelledBox> truth = {{1, -1, {10, 10, 10, 10}}, {1, -1, {70, 10, 10, 10}}};
  DrawBoxes(frame, {{1, -1, {11, 10, 10, 10}}, {1, -1, {40, 10, 10, 10}}}, &truth, "");
  // On the left edge of each box's frame.
  const auto colour = [&frame](int x) { return frame.at<cv::Vec3b>(15, x); };
  EXPECT_GT(colour(10)[1], 2 * colour(10)[2]) << "hit: green";
  EXPECT_GT(colour(39)[2], 2 * colour(39)[1]) << "false alarm: red";
  EXPECT_GT(std::min(colour(69)[1], colour(69)[2]), 3 * colour(69)[0]) << "miss: yellow";
  EXPECT_EQ(colour(9)[2], 0) << "truth that was hit is not drawn";
}

}  // namespace
}  // namespace windhover::replay
