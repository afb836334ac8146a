// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "replay/baselines/klt_registration.h"
#include "replay/benchmarks/timing.h"
#include "replay/offline/offline_detection.h"
#include "replay/offline/overlay.h"
#include "replay/render/renderer.h"
#include "replay/scoring/registration_score.h"

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

std::vector<FrameOutcome> DetectOffline() {
  OfflineDetection detection(Backend::Create("cpu"), 320, 240, {});
  for (const cv::Mat& frame : TheSmallFlight().frames) detection.Push(frame);
  detection.Drain();
  return detection.outcomes();
}

TEST(OfflineOptions, AreSetByNameWhereverTheyLive) {
  OfflineOptions options;
  SetOption(options, "reference=centre");
  SetOption(options, "k=7");
  SetOption(options, "threshold=31");
  SetOption(options, "min-area=5");
  SetOption(options, "device=cpu");
  EXPECT_EQ(options.registration.reference, ReferenceMode::kCentre);
  EXPECT_EQ(options.background.k, 7);
  EXPECT_EQ(options.background.threshold, 31);
  EXPECT_EQ(options.motion.min_area_px, 5);
  EXPECT_EQ(options.device.device, "cpu");
  EXPECT_THROW(SetOption(options, "k"), OptionError);
  EXPECT_THROW(SetOption(options, "k=many"), OptionError);
  EXPECT_THROW(SetOption(options, "no-such-option=1"), OptionError);
}

TEST(OfflineDetection, EveryFrameComesOutOnceAndTheSameEachTime) {
  const std::vector<FrameOutcome> one = DetectOffline();
  const std::vector<FrameOutcome> two = DetectOffline();
  ASSERT_EQ(one.size(), static_cast<std::size_t>(kFrames));
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].registration.frame_number, i);
    EXPECT_EQ(one[i].registration.previous_from_frame, two[i].registration.previous_from_frame);
    ASSERT_EQ(one[i].detections.size(), two[i].detections.size());
    for (std::size_t d = 0; d < one[i].detections.size(); ++d) {
      EXPECT_EQ(one[i].detections[d].box.x, two[i].detections[d].box.x);
      EXPECT_EQ(one[i].detections[d].track_id, two[i].detections[d].track_id);
    }
  }
}

TEST(OfflineDetection, ComposedHomographiesFollowTheTruth) {
  const RegistrationScore score = ScoreRegistration(FirstFromFrame(DetectOffline()),
                                                    TheSmallFlight().first_from_frame, 320, 240);
  EXPECT_EQ(score.pairs, kFrames - 1);
  EXPECT_LT(score.mean_px.value(), 0.3);
}

TEST(OfflineDetection, RefusesFramesThatAreTooSmall) {
  EXPECT_THROW(OfflineDetection(Backend::Create("cpu"), 16, 16, {}), OptionError);
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
