// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "replay/render/camera.h"

namespace windhover::replay {

// A convex outline in the picture, px.
class Outline {
 public:
  static constexpr std::size_t kMost = 12;

  void Add(const Eigen::Vector2d& point) {
    if (size_ < kMost) points_[size_++] = point;
  }
  bool empty() const { return size_ < 3; }
  std::size_t size() const { return size_; }
  const Eigen::Vector2d& operator[](std::size_t i) const { return points_[i]; }
  const Eigen::Vector2d* begin() const { return points_.data(); }
  const Eigen::Vector2d* end() const { return points_.data() + size_; }

 private:
  std::array<Eigen::Vector2d, kMost> points_{};
  std::size_t size_ = 0;
};

// The part of a convex flat piece, at most 10 points (x, y, height), that lies before the camera,
// as it is seen; less `shift` px. Empty where nothing lies before it.
template <typename Corners>
Outline VisibleOutline(const Camera& camera, const Corners& corners, const Eigen::Vector2d& shift) {
  constexpr double kNear = 0.3;  // m before the camera
  const auto in_camera = [&camera](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return camera.camera_from_world *
           Eigen::Vector3d(p.x() - camera.x_m, p.y() - camera.y_m, camera.altitude_m - p.z());
  };
  Outline outline;
  const auto add = [&](const Eigen::Vector3d& p) {
    outline.Add(Eigen::Vector2d(camera.centre_x, camera.centre_y) +
                camera.focal_px / p.z() * p.head<2>() - shift);
  };
  Eigen::Vector3d before = in_camera(corners[corners.size() - 1]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d here = in_camera(corners[i]);
    if ((before.z() > kNear) != (here.z() > kNear)) {
      add(before + (kNear - before.z()) / (here.z() - before.z()) * (here - before));
    }
    if (here.z() > kNear) add(here);
    before = here;
  }
  return outline;
}

}  // namespace windhover::replay
