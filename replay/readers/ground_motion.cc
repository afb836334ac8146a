// SPDX-License-Identifier: Apache-2.0
#include "replay/readers/ground_motion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "service/vision/homography.h"

namespace windhover::replay {
namespace {

// Points across and down on which the middle of the ground is counted.
constexpr int kGrid = 16;

Spread SpreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return {values.front(), median, values.back()};
}

Eigen::Vector2d GroundMiddle(int width, int height, const Eigen::Vector3d* horizon) {
  const Eigen::Vector2d centre((width - 1) / 2.0, (height - 1) / 2.0);
  if (horizon == nullptr) return centre;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int points = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Eigen::Vector2d point((i % kGrid + 0.5) / kGrid * width - 0.5,
                                (i / kGrid + 0.5) / kGrid * height - 0.5);
    if (horizon->dot(point.homogeneous()) <= 0) continue;
    sum += point;
    ++points;
  }
  return points > 0 ? Eigen::Vector2d(sum / points) : centre;
}

// Derivative of x -> Project(h, x) at x.
Eigen::Matrix2d Derivative(const Eigen::Matrix3d& h, const Eigen::Vector2d& x) {
  const Eigen::Vector3d image = h * x.homogeneous();
  const Eigen::Vector2d there = image.hnormalized();
  return (h.topLeftCorner<2, 2>() - there * h.block<1, 2>(2, 0)) / image.z();
}

// Share of the frame, 0 to 1, that the frame before shows, too. Exact where all of the frame is
// ground.
double Overlap(const Eigen::Matrix3d& previous_from_frame, int width, int height) {
  const Eigen::Matrix3d frame_from_previous = previous_from_frame.inverse();
  const std::vector<cv::Point2f> frame = {
      {-0.5F, -0.5F},
      {static_cast<float>(width) - 0.5F, -0.5F},
      {static_cast<float>(width) - 0.5F, static_cast<float>(height) - 0.5F},
      {-0.5F, static_cast<float>(height) - 0.5F}};
  std::vector<cv::Point2f> previous;
  for (const cv::Point2f& corner : frame) {
    const Eigen::Vector3d there = frame_from_previous * Eigen::Vector3d(corner.x, corner.y, 1);
    // A corner in the sky.
    if (there.z() <= 0) return OverlapShare(previous_from_frame, width, height, width, height);
    previous.emplace_back(static_cast<float>(there.x() / there.z()),
                          static_cast<float>(there.y() / there.z()));
  }
  std::vector<cv::Point2f> common;
  return cv::intersectConvexConvex(frame, previous, common) / (static_cast<double>(width) * height);
}

}  // namespace

GroundMotion TrueGroundMotion(const std::vector<Eigen::Matrix3d>& first_from_frame) {
  return {first_from_frame, std::vector<int>(first_from_frame.size(), 0)};
}

GroundMotion MeasuredGroundMotion(std::span<const FrameRegistration> registrations) {
  GroundMotion motion;
  for (const FrameRegistration& one : registrations) {
    const bool first = motion.segment.empty();
    motion.segment.push_back(first ? 0 : motion.segment.back() + (one.starts_segment ? 1 : 0));
    Eigen::Matrix3d next = one.previous_from_frame;
    if (!first) next = motion.first_from_frame.back() * next;
    // Known up to scale: kept from growing or vanishing over thousands of frames.
    motion.first_from_frame.push_back(next / next.norm());
  }
  return motion;
}

CameraStatistics SummariseCamera(const GroundMotion& motion, int width, int height,
                                 std::span<const Eigen::Vector3d> horizons) {
  CameraStatistics statistics;
  std::vector<double> shift;
  std::vector<double> rotation;
  std::vector<double> scale;
  std::vector<double> overlap;
  for (std::size_t i = 1; i < motion.first_from_frame.size(); ++i) {
    if (motion.segment[i] != motion.segment[i - 1]) {
      ++statistics.lost;
      continue;
    }
    const Eigen::Vector2d middle =
        GroundMiddle(width, height, horizons.empty() ? nullptr : &horizons[i]);
    Eigen::Matrix3d previous_from_frame =
        motion.first_from_frame[i - 1].inverse() * motion.first_from_frame[i];
    // The ground lies in front of the camera.
    previous_from_frame /= (previous_from_frame * middle.homogeneous()).z();
    const Eigen::Matrix2d derivative = Derivative(previous_from_frame, middle);
    ++statistics.pairs;
    shift.push_back((Project(previous_from_frame, middle) - middle).norm());
    rotation.push_back(std::abs(std::atan2(derivative(1, 0) - derivative(0, 1),
                                           derivative(0, 0) + derivative(1, 1))) *
                       180 / std::numbers::pi);
    scale.push_back(1 / std::sqrt(std::abs(derivative.determinant())));
    overlap.push_back(Overlap(previous_from_frame, width, height));
  }
  if (statistics.pairs == 0) return statistics;
  statistics.shift_px = SpreadOf(std::move(shift));
  statistics.rotation_deg = SpreadOf(std::move(rotation));
  statistics.scale = SpreadOf(std::move(scale));
  statistics.overlap = SpreadOf(std::move(overlap));
  return statistics;
}

}  // namespace windhover::replay
