// SPDX-License-Identifier: Apache-2.0
#include "replay/render/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "replay/render/path.h"
#include "replay/render/portable_math.h"

namespace windhover::replay {
namespace {

Eigen::Matrix3d RotationAbout(int axis, double angle) {
  const double c = Cosine(angle);
  const double s = Sine(angle);
  const int i = (axis + 1) % 3;
  const int j = (axis + 2) % 3;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation(i, i) = c;
  rotation(j, j) = c;
  rotation(i, j) = -s;
  rotation(j, i) = s;
  return rotation;
}

double Radians(double degrees) { return degrees * (kPi / 180.0); }

}  // namespace

Eigen::Matrix3d Camera::WorldFromPixel() const {
  Eigen::Matrix3d rays;
  rays << 1 / focal_px, 0, -centre_x / focal_px, 0, 1 / focal_px, -centre_y / focal_px, 0, 0, 1;
  return camera_from_world.transpose() * rays;
}

Eigen::Matrix3d Camera::GroundFromPixel() const {
  Eigen::Matrix3d ground;
  ground << altitude_m, 0, x_m, 0, altitude_m, y_m, 0, 0, 1;
  return ground * WorldFromPixel();
}

Eigen::Vector2d Camera::Project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen =
      camera_from_world * Eigen::Vector3d(point.x() - x_m, point.y() - y_m, altitude_m - point.z());
  return {centre_x + focal_px * seen.x() / seen.z(), centre_y + focal_px * seen.y() / seen.z()};
}

Eigen::Vector3d Camera::Horizon() const {
  // The drop along the ray of a pixel is linear in it.
  const Eigen::Vector3d drop = WorldFromPixel().row(2);
  const double steepness = drop.head<2>().norm();
  if (steepness < 1e-12 * std::abs(drop.z())) return Eigen::Vector3d::UnitZ();
  return drop / steepness;
}

CameraPath::CameraPath(const CameraPlan& plan, int width, int height, std::uint64_t seed)
    : plan_(plan),
      width_(width),
      height_(height),
      focal_px_(plan.altitude_m / plan.pixel_m * width / plan.nominal_width_px),
      seed_(seed) {}

// In [-1, 1].
double CameraPath::Wobble(int channel, double time) const {
  Random random(Mix(seed_, 0x0CA3E7A0 + static_cast<std::uint64_t>(channel)));
  double sum = 0.0;
  double period = plan_.wobble_period;
  for (const double weight : {0.25, 0.3, 0.45}) {
    period *= random.Uniform(0.9, 1.1);
    sum += weight * Sine(2 * kPi * (time / period + random.Uniform()));
    period *= 2.2;
  }
  return sum;
}

// In [-1, 1]: sines that no frame rate follows, slow enough to stay smooth within an exposure.
double CameraPath::Vibration(int channel, double time) const {
  Random random(Mix(seed_, 0x71B7A7E0 + static_cast<std::uint64_t>(channel)));
  double sum = 0.0;
  for (const double period : {1.37, 2.23, 3.71}) {
    sum += Sine(2 * kPi * (time / (period * random.Uniform(0.95, 1.05)) + random.Uniform())) / 3;
  }
  return sum;
}

Eigen::Vector3d CameraPath::PlaceAt(double time) const {
  Eigen::Vector2d place(plan_.start_x_m, plan_.start_y_m);
  const double angle =
      Radians(plan_.kind == PathKind::kOrbit ? plan_.orbit_deg * time : plan_.heading_deg);
  const Eigen::Vector2d forward(Cosine(angle), Sine(angle));
  switch (plan_.kind) {
    case PathKind::kStraight:
      place += plan_.speed_m * time * forward + plan_.sway_m * Wobble(0, time) * Right(forward);
      break;
    case PathKind::kOrbit:
      place += (plan_.radius_m + plan_.sway_m * Wobble(0, time)) * forward;
      break;
    case PathKind::kHover:
      place += plan_.sway_m * Eigen::Vector2d(Wobble(0, time), Wobble(5, time));
      break;
  }
  return {place.x(), place.y(), plan_.altitude_m + plan_.climb_m * Wobble(1, time)};
}

CameraPath::Pose CameraPath::PoseAt(double time) const {
  double yaw_deg =
      plan_.yaw_deg + plan_.yaw_rate_deg * time + plan_.yaw_wobble_deg * Wobble(2, time);
  if (plan_.kind == PathKind::kOrbit) yaw_deg += plan_.orbit_deg * time - 90;
  const double shake = plan_.jitter_px * plan_.pixel_m / plan_.altitude_m;  // radians
  const double pitch = shake * Vibration(0, time) +
                       Radians(plan_.attitude_wobble_deg * Wobble(3, time) - plan_.tilt_deg);
  const double roll =
      shake * Vibration(1, time) + Radians(plan_.attitude_wobble_deg * Wobble(4, time));
  const double swing = 0.5 - 0.5 * Cosine(2 * kPi * time / plan_.zoom_period);
  return {.place_m = PlaceAt(time),
          .angles = {pitch, roll, Radians(yaw_deg)},
          .focal_px = focal_px_ * (1 + (plan_.zoom - 1) * swing)};
}

Camera CameraPath::InPose(const Pose& pose) const {
  return {.x_m = pose.place_m.x(),
          .y_m = pose.place_m.y(),
          .altitude_m = pose.place_m.z(),
          .camera_from_world = RotationAbout(1, pose.angles[1]) * RotationAbout(0, pose.angles[0]) *
                               RotationAbout(2, -pose.angles[2]),
          .focal_px = pose.focal_px,
          .centre_x = 0.5 * (width_ - 1),
          .centre_y = 0.5 * (height_ - 1)};
}

Camera CameraPath::At(double time) const { return InPose(PoseAt(time)); }

Camera CameraPath::Mean(std::span<const double> times) const {
  Pose mean;
  const double share = 1.0 / static_cast<double>(times.size());
  for (const double time : times) {
    const Pose pose = PoseAt(time);
    mean.place_m += share * pose.place_m;
    mean.angles += share * pose.angles;
    mean.focal_px += share * pose.focal_px;
  }
  return InPose(mean);
}

}  // namespace windhover::replay
