// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <future>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "replay/render/fill.h"
#include "replay/render/portable_math.h"
#include "replay/render/renderer.h"

namespace windhover::replay {
namespace {

// Small, so that the test is quick; the kind of world and the camera are those of the real flight.
FlightPlan SmallPlan() {
  FlightPlan plan = FindFlightPlan("flight");
  plan.width = 320;
  plan.height = 240;
  plan.frames = 24;
  plan.traffic_density = 1;  // more to look at
  return plan;
}

const Renderer& SmallFlight() {
  static const Renderer renderer(SmallPlan(), 2);
  return renderer;
}

cv::Mat Luma(const cv::Mat& frame) {
  cv::Mat luma;
  cv::cvtColor(frame, luma, cv::COLOR_BGR2GRAY);
  luma.convertTo(luma, CV_32F);
  return luma;
}

// `later` as seen from `earlier`, by the true homography.
cv::Mat Warped(const Renderer& flight, int earlier, int later) {
  const Eigen::Matrix3d later_from_earlier =
      flight.Truth(later).first_from_frame.inverse() * flight.Truth(earlier).first_from_frame;
  const cv::Matx33d matrix(
      later_from_earlier(0, 0), later_from_earlier(0, 1), later_from_earlier(0, 2),
      later_from_earlier(1, 0), later_from_earlier(1, 1), later_from_earlier(1, 2),
      later_from_earlier(2, 0), later_from_earlier(2, 1), later_from_earlier(2, 2));
  cv::Mat warped;
  cv::warpPerspective(Luma(flight.Frame(later)), warped, matrix, {320, 240},
                      cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                      cv::Scalar(-1000));
  return warped;
}

TEST(PortableMath, CircularFunctions) {
  for (double x = -700; x < 700; x += 0.37) {
    EXPECT_NEAR(Sine(x), std::sin(x), 1e-13) << x;
    EXPECT_NEAR(Cosine(x), std::cos(x), 1e-13) << x;
  }
}

TEST(PortableMath, NormalHasTheStatedMoments) {
  Random random(5);
  double sum = 0;
  double square = 0;
  constexpr int kCount = 200000;
  for (int i = 0; i < kCount; ++i) {
    const double value = NormalFromBits(random.Bits());
    sum += value;
    square += value * value;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(square / kCount, 1, 0.01);
}

TEST(Fill, CoversPixelCentresOnce) {
  // A square cut into two triangles: each centre belongs to one of them.
  cv::Mat count(20, 20, CV_8U, cv::Scalar(0));
  const auto add = [&](int x, int y) { ++count.at<std::uint8_t>(y, x); };
  using Triangle = std::array<Eigen::Vector2d, 3>;
  ForEachPixelInside(Triangle{{{2, 3}, {12, 3}, {12, 13}}}, 0, 20, 0, 20, add);
  ForEachPixelInside(Triangle{{{2, 3}, {12, 13}, {2, 13}}}, 0, 20, 0, 20, add);
  EXPECT_EQ(cv::countNonZero(count == 1), 100);
  EXPECT_EQ(cv::countNonZero(count > 1), 0);
}

TEST(Camera, ProjectInvertsTheRays) {
  const CameraPath path(CameraPlan{}, 640, 480, 3);
  const Camera camera = path.At(77.25);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(631.5, 20.25)}) {
    const Eigen::Vector2d spot = (camera.GroundFromPixel() * pixel.homogeneous()).hnormalized();
    EXPECT_LT((camera.Project({spot.x(), spot.y(), 0}) - pixel).norm(), 1e-9);
  }
}

void ExpectSameBoxes(const std::vector<LabelledBox>& a, const std::vector<LabelledBox>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].frame, b[i].frame);
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].box.x, b[i].box.x);
    EXPECT_EQ(a[i].box.y, b[i].box.y);
    EXPECT_EQ(a[i].box.width, b[i].box.width);
    EXPECT_EQ(a[i].box.height, b[i].box.height);
    EXPECT_EQ(a[i].score, b[i].score);
    EXPECT_EQ(a[i].visible, b[i].visible);
  }
}

TEST(Renderer, TheSamePlanGivesTheSameBitsOnAnyThreads) {
  FlightPlan plan = SmallPlan();
  plan.width = 160;
  plan.height = 120;
  plan.frames = 6;
  const Renderer one(plan, 1);
  const Renderer many(plan, 5);
  std::vector<std::future<cv::Mat>> frames;
  for (int i = plan.frames - 1; i >= 0; --i) {
    frames.push_back(std::async(std::launch::async, [&many, i] { return many.Frame(i); }));
  }
  for (int i = 0; i < plan.frames; ++i) {
    const cv::Mat frame = frames[plan.frames - 1 - i].get();
    EXPECT_EQ(cv::norm(one.Frame(i), frame, cv::NORM_INF), 0) << i;
    const FrameTruth a = one.Truth(i);
    const FrameTruth b = many.Truth(i);
    EXPECT_EQ(a.first_from_frame, b.first_from_frame);
    ExpectSameBoxes(a.movers, b.movers);
    ExpectSameBoxes(a.decoys, b.decoys);
  }
  plan.seed += 1;
  const Renderer other(plan, 2);
  EXPECT_GT(cv::norm(one.Frame(0), other.Frame(0), cv::NORM_L1), 1e5);
}

TEST(Renderer, TheGroundFollowsTheTrueHomography) {
  const cv::Mat earlier = Luma(SmallFlight().Frame(4));
  const cv::Mat warped = Warped(SmallFlight(), 4, 5);
  // Half of all pixels differ by less than noise explains: 0.6745 of sqrt(2) times its spread.
  std::vector<float> differences;
  for (int y = 0; y < earlier.rows; ++y) {
    for (int x = 0; x < earlier.cols; ++x) {
      const float other = warped.at<float>(y, x);
      if (other > -1) differences.push_back(std::abs(other - earlier.at<float>(y, x)));
    }
  }
  ASSERT_GT(differences.size(), 50000U);
  std::nth_element(differences.begin(), differences.begin() + differences.size() / 2,
                   differences.end());
  EXPECT_LT(differences[differences.size() / 2], 0.6745 * std::sqrt(2.0) * 2.9);
}

// How far, px, `later` warped by the true homography lies from `earlier`: where moving it would fit
// best.
Eigen::Vector2d Misplacement(const Renderer& flight, int earlier, int later) {
  const cv::Mat target = Luma(flight.Frame(earlier));
  const cv::Mat warped = Warped(flight, earlier, later);
  const auto misfit = [&](double x, double y) {
    const cv::Matx23d shift(1, 0, x, 0, 1, y);
    cv::Mat moved;
    cv::warpAffine(warped, moved, shift, warped.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP);
    cv::Mat difference;
    cv::absdiff(moved, target, difference);
    cv::min(difference, 20.0, difference);
    return cv::mean(difference(cv::Rect(40, 40, 240, 160)))[0];
  };
  // The parabola through three points has its lowest point where the picture really lies.
  const auto lowest = [](double low, double middle, double high) {
    return 0.25 * (low - high) / (low - 2 * middle + high);
  };
  const double middle = misfit(0, 0);
  return {lowest(misfit(-0.5, 0), middle, misfit(0.5, 0)),
          lowest(misfit(0, -0.5), middle, misfit(0, 0.5))};
}

TEST(Renderer, TheTrueHomographyIsTheBestShift) {
  const Eigen::Vector2d misplacement = Misplacement(SmallFlight(), 4, 6);
  EXPECT_NEAR(misplacement.x(), 0, 0.05);
  EXPECT_NEAR(misplacement.y(), 0, 0.05);
}

TEST(Renderer, TheTrueHomographyOfAShakingCameraIsThatOfTheWholeExposure) {
  FlightPlan plan = SmallPlan();
  plan.frames = 8;
  plan.camera.jitter_px = 8;
  plan.sensor.exposure_share = 0.5;
  const Renderer flight(plan, 2);
  for (int frame = 0; frame < 6; ++frame) {
    const Eigen::Vector2d misplacement = Misplacement(flight, frame, frame + 1);
    // Two blurs of different shape fit best a little beside their middles; the camera at the middle
    // of the exposure is up to 2 px away.
    EXPECT_LT(misplacement.norm(), 0.2) << frame;
  }
}

// The least rectangle around the pixels where the pictures differ by more than a rounding.
cv::Rect Difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  cv::Mat differs = difference.reshape(1, a.rows * a.cols) > 2;
  cv::reduce(differs, differs, 1, cv::REDUCE_MAX);
  return cv::boundingRect(differs.reshape(1, a.rows));
}

TEST(Renderer, BoxesAreTightAroundWhatTheVehicleChanges) {
  // What a perfect camera sees with and without the vehicle: no noise, no blur of any kind.
  FlightPlan plan = SmallPlan();
  plan.sensor = {
      .exposure_share = 0, .psf_sigma_px = 0, .read_sigma = 0, .shot_gain = 0, .chroma_sigma = 0};
  const Renderer flight(plan, 2);
  constexpr int kFrame = 10;
  const cv::Mat all = flight.Frame(kFrame);
  const FrameTruth truth = flight.Truth(kFrame);
  ASSERT_GE(truth.movers.size(), 3U);
  ASSERT_GE(truth.decoys.size(), 3U);
  for (const std::vector<LabelledBox>* boxes : {&truth.movers, &truth.decoys}) {
    for (const LabelledBox& box : *boxes) {
      const cv::Rect seen = Difference(all, flight.Frame(kFrame, box.id));
      EXPECT_NEAR(box.box.x, seen.x, 1) << "left of " << box.id;
      EXPECT_NEAR(box.box.y, seen.y, 1) << "top of " << box.id;
      EXPECT_NEAR(box.box.x + box.box.width, seen.x + seen.width, 1) << "right of " << box.id;
      EXPECT_NEAR(box.box.y + box.box.height, seen.y + seen.height, 1) << "bottom of " << box.id;
    }
  }
}

TEST(Renderer, MoversTravelOverTheGroundAndDecoysDoNot) {
  const Renderer& flight = SmallFlight();
  constexpr int kFrame = 10;
  constexpr int kHalf = kMoverWindowFrames / 2;
  // Where the middles of the boxes lie in the picture of frame 0; a roof moves against the ground
  // by its parallax, and boxes are of whole pixels.
  const auto middles = [&flight](int frame) {
    const FrameTruth truth = flight.Truth(frame);
    std::map<std::int64_t, Eigen::Vector2d> found;
    for (const std::vector<LabelledBox>* boxes : {&truth.movers, &truth.decoys}) {
      for (const LabelledBox& box : *boxes) {
        if (box.visible < 0.95) continue;
        const Eigen::Vector2d middle(box.box.x + (box.box.width - 1) / 2,
                                     box.box.y + (box.box.height - 1) / 2);
        found[box.id] = (truth.first_from_frame * middle.homogeneous()).hnormalized();
      }
    }
    return found;
  };
  const auto before = middles(kFrame - kHalf);
  const auto after = middles(kFrame + kHalf);
  const auto ways = [&](const std::vector<LabelledBox>& boxes) {
    std::vector<double> found;
    for (const LabelledBox& box : boxes) {
      if (before.count(box.id) == 0 || after.count(box.id) == 0) continue;
      found.push_back((after.at(box.id) - before.at(box.id)).norm());
    }
    return found;
  };
  constexpr double kTolerancePx = 1;
  const FrameTruth truth = flight.Truth(kFrame);
  const std::vector<double> moving = ways(truth.movers);
  const std::vector<double> standing = ways(truth.decoys);
  ASSERT_GE(moving.size(), 3U);
  ASSERT_GE(standing.size(), 3U);
  EXPECT_THAT(moving, testing::Each(testing::Gt(kMoverTravelPx - kTolerancePx)));
  EXPECT_THAT(standing, testing::Each(testing::Lt(kMoverTravelPx + kTolerancePx)));
}

TEST(Renderer, TruthKeepsItsRules) {
  const Renderer& flight = SmallFlight();
  for (const int frame : {0, 11, 23}) {
    const FrameTruth truth = flight.Truth(frame);
    for (const std::vector<LabelledBox>* boxes : {&truth.movers, &truth.decoys}) {
      for (const LabelledBox& box : *boxes) {
        EXPECT_EQ(box.frame, frame + 1);
        EXPECT_GE(box.visible, box.score > 0 ? kLeastVisible : kLeastMarked);
        EXPECT_EQ(box.score > 0, box.visible >= kLeastVisible);
        if (boxes == &truth.decoys) {
          EXPECT_EQ(box.score, 1);
        }
        EXPECT_GE(std::min(box.box.width, box.box.height), kLeastWidthPx);
        EXPECT_GE(box.box.x, 0);
        EXPECT_GE(box.box.y, 0);
        EXPECT_LE(box.box.x + box.box.width, 320);
        EXPECT_LE(box.box.y + box.box.height, 240);
      }
    }
  }
  EXPECT_EQ(flight.Truth(0).first_from_frame, Eigen::Matrix3d::Identity());
}

TEST(Renderer, RefusesPlansThatMakeNoSense) {
  FlightPlan plan = SmallPlan();
  plan.frames = 0;
  EXPECT_THROW(Renderer(plan, 1), std::invalid_argument);
  EXPECT_THROW(FindFlightPlan("99"), std::invalid_argument);
  EXPECT_EQ(FindFlightPlan("1").name, "outskirts");
  EXPECT_EQ(FindFlightPlan("outskirts").number, "01");
}

}  // namespace
}  // namespace windhover::replay
