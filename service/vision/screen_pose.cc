// SPDX-License-Identifier: Apache-2.0
#include "service/vision/screen_pose.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace windhover {
namespace {

// A convex polygon: a quadrangle gains at most a corner at each of four cuts.
struct Polygon {
  std::array<Eigen::Vector2d, 8> corners;
  int count = 0;

  void Add(const Eigen::Vector2d& corner) { corners[count++] = corner; }
};

// What of the polygon lies where distance >= 0, a linear function of the point (Sutherland and
// Hodgman's clipping, one edge of it).
template <typename Distance>
Polygon Cut(const Polygon& polygon, Distance distance) {
  Polygon rest;
  for (int i = 0; i < polygon.count; ++i) {
    const Eigen::Vector2d& from = polygon.corners[i];
    const Eigen::Vector2d& to = polygon.corners[(i + 1) % polygon.count];
    const double at_from = distance(from);
    const double at_to = distance(to);
    if (at_from >= 0.0) rest.Add(from);
    if ((at_from >= 0.0) != (at_to >= 0.0)) {
      rest.Add(from + (to - from) * (at_from / (at_from - at_to)));
    }
  }
  return rest;
}

double Area(const Polygon& polygon) {
  double twice = 0.0;
  for (int i = 0; i < polygon.count; ++i) {
    const Eigen::Vector2d& a = polygon.corners[i];
    const Eigen::Vector2d& b = polygon.corners[(i + 1) % polygon.count];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * twice;
}

// A turn by so many radians about the picture's centre.
Eigen::Matrix3d Turn(double radians, int width, int height) {
  const Eigen::Vector2d centre(0.5 * (width - 1), 0.5 * (height - 1));
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(radians).toRotationMatrix();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = rotation;
  turn.topRightCorner<2, 1>() = centre - rotation * centre;
  return turn;
}

// By how much the homography turns the picture's middle, radians.
double TurnOf(const Eigen::Matrix3d& b_from_a, int width, int height) {
  const Eigen::Vector3d centre(0.5 * (width - 1), 0.5 * (height - 1), 1.0);
  const Eigen::Vector3d at = b_from_a * centre;
  const Eigen::Matrix2d slope =
      b_from_a.topLeftCorner<2, 2>() - at.hnormalized() * b_from_a.block<1, 2>(2, 0);
  return std::atan2(slope(1, 0) - slope(0, 1), slope(0, 0) + slope(1, 1));
}

bool IsPose(const Eigen::Matrix3d& screen_from_frame, int width, int height) {
  return IsOrientationPreserving(screen_from_frame, width, height) &&
         IsOrientationPreserving(InverseHomography(screen_from_frame), width, height);
}

}  // namespace

Eigen::Matrix3d HomographyOfCorners(const std::array<Eigen::Vector2d, 4>& corners, int width,
                                    int height) {
  // From the unit square, where the equations are well conditioned.
  const std::array<Eigen::Vector2d, 4> square = PictureCorners(2, 2);
  Matrix8d equations;
  Eigen::Matrix<double, 8, 1> values;
  for (int i = 0; i < 4; ++i) {
    const double x = square[i].x();
    const double y = square[i].y();
    const Eigen::Vector2d& to = corners[i];
    equations.row(2 * i) << x, y, 1, 0, 0, 0, -to.x() * x, -to.x() * y;
    equations.row(2 * i + 1) << 0, 0, 0, x, y, 1, -to.y() * x, -to.y() * y;
    values.segment<2>(2 * i) = to;
  }
  const Eigen::Matrix<double, 8, 1> h = equations.partialPivLu().solve(values);
  Eigen::Matrix3d from_square;
  from_square << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
  const Eigen::Vector3d to_square(1.0 / (width - 1), 1.0 / (height - 1), 1.0);
  return from_square * to_square.asDiagonal();
}

Eigen::Matrix3d BlendHomographies(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b,
                                  double share_of_b, int width, int height) {
  // The turn by itself: corners on straight ways would shrink a turning picture.
  const double turn_a = TurnOf(a, width, height);
  const double turn_b = TurnOf(b, width, height);
  const Eigen::Matrix3d upright_a = Turn(-turn_a, width, height) * a;
  const Eigen::Matrix3d upright_b = Turn(-turn_b, width, height) * b;
  std::array<Eigen::Vector2d, 4> corners = PictureCorners(width, height);
  for (Eigen::Vector2d& x : corners) {
    x = (1.0 - share_of_b) * Project(upright_a, x) + share_of_b * Project(upright_b, x);
  }
  const double turn = turn_a + share_of_b * std::remainder(turn_b - turn_a, 2.0 * M_PI);
  return Turn(turn, width, height) * HomographyOfCorners(corners, width, height);
}

double CoveredShare(const Eigen::Matrix3d& b_from_a, int width, int height) {
  Polygon shared;
  for (const Eigen::Vector2d& x : PictureCorners(width, height)) shared.Add(Project(b_from_a, x));
  const double right = width - 1;
  const double bottom = height - 1;
  shared = Cut(shared, [](const Eigen::Vector2d& x) { return x.x(); });
  shared = Cut(shared, [=](const Eigen::Vector2d& x) { return right - x.x(); });
  shared = Cut(shared, [](const Eigen::Vector2d& x) { return x.y(); });
  shared = Cut(shared, [=](const Eigen::Vector2d& x) { return bottom - x.y(); });
  return Area(shared) / (right * bottom);
}

Eigen::Matrix3d CropAsPose(double crop, int width, int height) {
  const double zoom = 1.0 / (1.0 - crop);
  Eigen::Matrix3d pose = Eigen::Vector3d(zoom, zoom, 1.0).asDiagonal();
  pose.topRightCorner<2, 1>() << 0.5 * (width - 1) * (1.0 - zoom),
      0.5 * (height - 1) * (1.0 - zoom);
  return pose;
}

PoseLimits::PoseLimits(int width, int height, double crop, double max_uncovered, double max_hidden)
    : width_(width),
      height_(height),
      max_uncovered_(max_uncovered),
      min_seen_((1.0 - max_hidden) * (1.0 - crop) * (1.0 - crop)),
      rest_(CropAsPose(crop, width, height)) {}

bool PoseLimits::Allow(const Eigen::Matrix3d& screen_from_frame) const {
  if (!IsPose(screen_from_frame, width_, height_)) return false;
  constexpr double kRounding = 1e-6;
  return CoveredShare(screen_from_frame, width_, height_) >= 1.0 - max_uncovered_ - kRounding &&
         CoveredShare(InverseHomography(screen_from_frame), width_, height_) >=
             min_seen_ - kRounding;
}

Eigen::Matrix3d PoseLimits::Restrict(const Eigen::Matrix3d& screen_from_frame) const {
  if (Allow(screen_from_frame)) return screen_from_frame;
  if (!IsPose(screen_from_frame, width_, height_)) return rest_;
  // Blended as frame_from_screen: but for turns, the screen's corners go straight to where they are
  // at rest, so that they stay inside the frame from where they have entered it.
  const Eigen::Matrix3d frame_from_screen = InverseHomography(screen_from_frame);
  const Eigen::Matrix3d frame_from_rest = InverseHomography(rest_);
  Eigen::Matrix3d best = rest_;
  double refused = 0.0;
  double allowed = 1.0;
  constexpr int kHalvings = 16;
  for (int i = 0; i < kHalvings; ++i) {
    const double share = 0.5 * (refused + allowed);
    const Eigen::Matrix3d blend = InverseHomography(
        BlendHomographies(frame_from_screen, frame_from_rest, share, width_, height_));
    if (Allow(blend)) {
      allowed = share;
      best = blend;
    } else {
      refused = share;
    }
  }
  return best;
}

}  // namespace windhover
