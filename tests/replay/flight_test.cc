// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "replay/render/camera.h"
#include "replay/render/compression.h"
#include "replay/render/flight_plan.h"
#include "replay/render/portable_math.h"
#include "replay/render/sensor.h"

// How the camera flies, and what the sensor makes of light.

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// Without any wobble.
CameraPlan SteadyPlan() {
  CameraPlan plan;
  plan.yaw_rate_deg = 0;
  plan.yaw_wobble_deg = 0;
  plan.tilt_deg = 0;
  plan.sway_m = 0;
  plan.climb_m = 0;
  plan.attitude_wobble_deg = 0;
  return plan;
}

CameraPath PathOf(const CameraPlan& plan) { return {plan, 640, 480, 7}; }

// The point of the map in the middle of the picture.
Vector2d AimOf(const Camera& camera) {
  return (camera.GroundFromPixel() * Eigen::Vector3d(camera.centre_x, camera.centre_y, 1))
      .hnormalized();
}

TEST(CameraPath, ForwardFlightLetsTheGroundComeDownThePicture) {
  CameraPlan plan = SteadyPlan();
  plan.heading_deg = 30;
  plan.yaw_deg = 120;  // the picture's top ahead
  plan.tilt_deg = 40;
  const CameraPath path = PathOf(plan);
  const Vector2d aim = AimOf(path.At(10));
  const Vector2d later = path.At(15).Project({aim.x(), aim.y(), 0});
  EXPECT_NEAR(later.x(), 319.5, 1e-6);
  EXPECT_GT(later.y(), 250);
  // One looks ahead, not back.
  const Vector2d ahead = aim - Vector2d(path.At(10).x_m, path.At(10).y_m);
  EXPECT_NEAR(ahead.norm(), 120 * std::tan(40 * kPi / 180), 1e-6);
  EXPECT_NEAR(std::atan2(ahead.y(), ahead.x()), 30 * kPi / 180, 1e-9);
}

TEST(CameraPath, AnOrbitKeepsItsCentreInSight) {
  CameraPlan plan = SteadyPlan();
  plan.kind = PathKind::kOrbit;
  plan.start_x_m = 40;
  plan.start_y_m = -25;
  plan.radius_m = plan.altitude_m;
  plan.tilt_deg = 45;
  plan.orbit_deg = 0.7;
  const CameraPath path = PathOf(plan);
  for (const double time : {0.0, 100.5, 391.0}) {
    const Camera camera = path.At(time);
    EXPECT_LT((AimOf(camera) - Vector2d(40, -25)).norm(), 1e-6);
    EXPECT_NEAR((Vector2d(camera.x_m, camera.y_m) - Vector2d(40, -25)).norm(), plan.radius_m, 1e-9);
  }
  const Vector2d start(path.At(0).x_m - 40, path.At(0).y_m + 25);
  const Vector2d later(path.At(100).x_m - 40, path.At(100).y_m + 25);
  EXPECT_NEAR(std::acos(start.dot(later) / start.norm() / later.norm()), 70 * kPi / 180, 1e-9);
}

TEST(CameraPath, HoveringStaysWhereItIs) {
  CameraPlan plan = SteadyPlan();
  plan.kind = PathKind::kHover;
  plan.sway_m = 0.5;
  const CameraPath path = PathOf(plan);
  double farthest = 0;
  for (int frame = 0; frame < 500; ++frame) {
    farthest = std::max(farthest, Vector2d(path.At(frame).x_m, path.At(frame).y_m).norm());
  }
  EXPECT_GT(farthest, 0.2);
  EXPECT_LT(farthest, 0.75);
}

TEST(CameraPath, ZoomSwingsTheFocalLengthAlone) {
  CameraPlan plan = SteadyPlan();
  plan.zoom = 1.5;
  plan.zoom_period = 200;
  const CameraPath path = PathOf(plan);
  const double own = path.At(0).focal_px;
  EXPECT_NEAR(own, 120 / 0.22, 1e-9);
  EXPECT_NEAR(path.At(100).focal_px, 1.5 * own, 1e-9);
  EXPECT_NEAR(path.At(200).focal_px, own, 1e-9);
  EXPECT_NEAR(path.pixel_m(), 0.22 / 1.5, 1e-9);
  EXPECT_NEAR(path.At(100).altitude_m, 120, 1e-9);
}

TEST(CameraPath, VibrationJumpsBetweenFramesAndIsSmoothWithinAnExposure) {
  CameraPlan plan = SteadyPlan();
  plan.speed_m = 0;
  plan.jitter_px = 4;
  const CameraPath path = PathOf(plan);
  const auto shift = [&](double a, double b) {
    const Vector2d spot = AimOf(path.At(a));
    return (path.At(b).Project({spot.x(), spot.y(), 0}) - Vector2d(319.5, 239.5)).norm();
  };
  std::vector<double> jumps;
  for (int frame = 0; frame < 200; ++frame) {
    jumps.push_back(shift(frame, frame + 1));
    // A hundredth of a frame moves the picture by little: no steps.
    EXPECT_LT(shift(frame + 0.1, frame + 0.11), 0.3);
  }
  std::nth_element(jumps.begin(), jumps.begin() + 100, jumps.end());
  EXPECT_GT(jumps[100], 2.0) << "px a frame";
  EXPECT_LT(jumps[100], 8.0);
}

TEST(Camera, TheHorizonPartsRaysDownFromRaysUp) {
  CameraPlan plan = SteadyPlan();
  plan.tilt_deg = 80;
  plan.attitude_wobble_deg = 3;
  const Camera camera = PathOf(plan).At(33);
  const Eigen::Vector3d horizon = camera.Horizon();
  EXPECT_NEAR(horizon.head<2>().norm(), 1, 1e-12);
  EXPECT_GT(horizon.dot(Eigen::Vector3d(320, 479, 1)), 0);
  EXPECT_LT(horizon.dot(Eigen::Vector3d(320, 0, 1)), 0);
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d pixel(random.Uniform(0, 640), random.Uniform(0, 480), 1);
    const double drop = (camera.WorldFromPixel() * pixel).z();
    EXPECT_EQ(drop > 0, horizon.dot(pixel) > 0);
  }
  EXPECT_EQ(PathOf(SteadyPlan()).At(0).Horizon(), Eigen::Vector3d(0, 0, 1));
}

TEST(FlightPlans, AreFoundOneByOneAndTogether) {
  EXPECT_EQ(FindFlightPlans("1").size(), 1U);
  EXPECT_EQ(FindFlightPlans("flight").front().number, "01");
  EXPECT_THROW(FindFlightPlans("1,01"), std::invalid_argument);
  EXPECT_THROW(FindFlightPlans("1,"), std::invalid_argument);
  EXPECT_THROW(FindFlightPlans("all,1"), std::invalid_argument);
  for (const FlightPlan& plan : FindFlightPlans("all")) EXPECT_LE(plan.number, "10");
}

cv::Mat Light(float level) { return {120, 160, CV_32FC3, cv::Scalar::all(level)}; }

SensorPlan QuietPlan() {
  SensorPlan plan;
  plan.psf_sigma_px = 0;
  plan.read_sigma = 0;
  plan.shot_gain = 0;
  plan.chroma_sigma = 0;
  return plan;
}

TEST(Sensor, ExposureStepsComeWhenPlanned) {
  SensorPlan plan = QuietPlan();
  plan.steps = {{10, 4, 1.5, -20}, {30, 1, 0.8, 5}};
  const Sensor sensor(plan, 1);
  const auto level = [&](int frame) {
    cv::Mat light = Light(100);
    return static_cast<int>(sensor.Expose(light, frame).at<cv::Vec3b>(60, 80)[1]);
  };
  EXPECT_EQ(level(0), 100);
  EXPECT_EQ(level(10), 100);
  EXPECT_EQ(level(12), 115);  // half-way to 1.5 * 100 - 20
  EXPECT_EQ(level(14), 130);
  EXPECT_EQ(level(30), 130);
  EXPECT_EQ(level(31), 85);
  EXPECT_EQ(level(400), 85);
}

TEST(Sensor, NightIsGreyNoisyAndStriped) {
  SensorPlan plan = QuietPlan();
  plan.grey = true;
  plan.read_sigma = 6;
  plan.column_sigma = 2;
  const Sensor sensor(plan, 1);
  cv::Mat first = Light(100);
  cv::Mat second = Light(100);
  std::vector<cv::Mat> a;
  std::vector<cv::Mat> b;
  cv::split(sensor.Expose(first, 0), a);
  cv::split(sensor.Expose(second, 1), b);
  EXPECT_EQ(cv::norm(a[0], a[2], cv::NORM_INF), 0);
  cv::Mat difference;
  cv::subtract(a[0], b[0], difference, {}, CV_32F);
  cv::Scalar mean;
  cv::Scalar spread;
  cv::meanStdDev(difference, mean, spread);
  EXPECT_NEAR(spread[0], std::sqrt(2.0) * 6, 0.4);  // the stripes do not change
  cv::Mat columns;
  cv::reduce(a[0], columns, 0, cv::REDUCE_AVG, CV_32F);
  cv::meanStdDev(columns, mean, spread);
  EXPECT_NEAR(spread[0], std::sqrt(4 + 36.0 / 120), 0.5);
}

TEST(Sensor, CornersLoseLight) {
  SensorPlan plan = QuietPlan();
  plan.vignetting = 0.3;
  cv::Mat light = Light(200);
  const cv::Mat picture = Sensor(plan, 1).Expose(light, 0);
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 80)[1], 200);
  EXPECT_NEAR(picture.at<cv::Vec3b>(0, 0)[1], 140, 2);
}

// A textured picture that moves.
cv::Mat Moving(int frame) {
  cv::Mat picture(118, 161, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto column = static_cast<float>(x + 2 * frame);
      const auto row = static_cast<float>(y);
      const float noise =
          Noise(column / 7, row / 7, 1) + 0.5F * Noise(column / 2.1F, row / 2.1F, 2);
      picture.at<cv::Vec3b>(y, x) =
          cv::Vec3b::all(static_cast<std::uint8_t>(std::clamp(120 + 60 * noise, 0.0F, 255.0F)));
    }
  }
  return picture;
}

TEST(Compression, RepeatsToTheBitAndNeverLooksAhead) {
  constexpr int kFrames = 60;  // beyond a key frame
  std::vector<cv::Mat> whole;
  Compression first(161, 118, 30);
  for (int i = 0; i < kFrames; ++i) whole.push_back(first.Pass(Moving(i)));
  Compression second(161, 118, 30);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(cv::norm(second.Pass(Moving(i)), whole[i], cv::NORM_INF), 0) << i;
  }
  // What comes later does not matter.
  Compression third(161, 118, 30);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(cv::norm(third.Pass(Moving(i)), whole[i], cv::NORM_INF), 0);
  third.Pass(Moving(500));
}

TEST(Compression, LosesMoreTheCoarserItIs) {
  const auto loss = [](int quantiser) {
    Compression compression(161, 118, quantiser);
    double worst = 1e9;
    for (int i = 0; i < 5; ++i) {
      worst = std::min(worst, cv::PSNR(compression.Pass(Moving(i)), Moving(i)));
    }
    return worst;
  };
  EXPECT_GT(loss(18), loss(28) + 2);
  EXPECT_GT(loss(28), loss(38) + 2);
  EXPECT_GT(loss(38), 18);  // it is still the same picture
}

}  // namespace
}  // namespace windhover::replay
