// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "replay/render/flight_plan.h"

namespace windhover::replay {

// A pinhole camera above the map. World points are (x, y, height); the camera's own axes are x
// right, y down the picture, z away from it.
struct Camera {
  double x_m = 0.0;
  double y_m = 0.0;
  double altitude_m = 0.0;
  // Takes (dx, dy, drop below the camera) to the camera's axes.
  Eigen::Matrix3d camera_from_world = Eigen::Matrix3d::Identity();
  double focal_px = 1.0;
  // Where the optical axis meets the picture, px.
  double centre_x = 0.0;
  double centre_y = 0.0;

  // Pixels to points of the map at height 0, m.
  Eigen::Matrix3d GroundFromPixel() const;
  // Direction (dx, dy, drop) of a pixel (u, v, 1), up to its length.
  Eigen::Matrix3d WorldFromPixel() const;
  // The pixel of a point in front of the camera.
  Eigen::Vector2d Project(const Eigen::Vector3d& point) const;
};

// Follows the plan smoothly: any time is allowed, also between and outside the frames.
class CameraPath {
 public:
  CameraPath(const CameraPlan& plan, int width, int height, std::uint64_t seed);

  // `time` in frames.
  Camera At(double time) const;
  // Size of a ground pixel below the camera at the plan's altitude, m.
  double pixel_m() const { return plan_.altitude_m / focal_px_; }

 private:
  double Wobble(int channel, double time) const;

  CameraPlan plan_;
  int width_;
  int height_;
  double focal_px_;
  std::uint64_t seed_;
};

}  // namespace windhover::replay
