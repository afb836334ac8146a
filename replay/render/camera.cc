// SPDX-License-Identifier: Apache-2.0
#include "replay/render/camera.h"

#include <Eigen/LU>

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

Camera CameraPath::At(double time) const {
  Camera camera;
  camera.x_m = plan_.start_x_m + plan_.speed_m * time;
  camera.y_m = plan_.sway_m * Wobble(0, time);
  camera.altitude_m = plan_.altitude_m + plan_.climb_m * Wobble(1, time);
  const double yaw = Radians(plan_.yaw_rate_deg * (time + 4 * Wobble(2, time)));
  const double pitch = Radians(plan_.tilt_deg + plan_.attitude_wobble_deg * Wobble(3, time));
  const double roll = Radians(plan_.attitude_wobble_deg * Wobble(4, time));
  camera.camera_from_world =
      RotationAbout(1, roll) * RotationAbout(0, pitch) * RotationAbout(2, -yaw);
  camera.focal_px = focal_px_;
  camera.centre_x = 0.5 * (width_ - 1);
  camera.centre_y = 0.5 * (height_ - 1);
  return camera;
}

}  // namespace windhover::replay
