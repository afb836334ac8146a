// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

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
  // (a, b, c): pixels (u, v) see ground where a u + b v + c > 0, and (a, b) has unit length. A
  // camera that looks straight down has no horizon: (0, 0, 1).
  Eigen::Vector3d Horizon() const;
};

// Follows the plan smoothly: any time is allowed, also between and outside the frames.
class CameraPath {
 public:
  CameraPath(const CameraPlan& plan, int width, int height, std::uint64_t seed);

  // `time` in frames.
  Camera At(double time) const;
  // In the mean of its poses at `times`, at least one.
  Camera Mean(std::span<const double> times) const;
  // The smallest that a ground pixel straight below gets at the plan's altitude, m.
  double pixel_m() const { return plan_.altitude_m / (focal_px_ * std::max(1.0, plan_.zoom)); }

 private:
  struct Pose {
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  // x, y, altitude
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();   // pitch, roll, yaw, radians
    double focal_px = 0.0;
  };

  double Wobble(int channel, double time) const;
  double Vibration(int channel, double time) const;
  Eigen::Vector3d PlaceAt(double time) const;
  Pose PoseAt(double time) const;
  Camera InPose(const Pose& pose) const;

  CameraPlan plan_;
  int width_;
  int height_;
  double focal_px_;
  std::uint64_t seed_;
};

}  // namespace windhover::replay
