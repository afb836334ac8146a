// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "gpu-kernels/backend.h"

namespace windhover {

// A flat ground with texture at every scale, seen through known homographies: exact truth for
// geometry tests. The same seed gives the same ground.
class SyntheticGround {
 public:
  explicit SyntheticGround(std::uint32_t seed = 1);

  // Grey value at a point of the ground, px; smooth, 20 to 235.
  double At(double x, double y) const;

  // The picture whose pixel x sees the ground at ground_from_frame(x), plus Gaussian noise of
  // `noise_sigma` grey levels drawn from `noise_seed`. `paint`, where given, may replace the value
  // v of the pixel (x, y).
  void Render(const Eigen::Matrix3d& ground_from_frame, double noise_sigma,
              std::uint32_t noise_seed, GrayImage& frame,
              const std::function<double(int x, int y, double v)>& paint = {}) const;

 private:
  static constexpr int kLattice = 256;
  std::vector<float> lattice_;
};

// A turn by `radians` and a zoom about the centre of a width x height picture, a shift in px, and
// perspective: as ground_from_frame, how a camera moved.
Eigen::Matrix3d CameraMotion(int width, int height, double radians, double zoom, double dx,
                             double dy, double perspective = 0.0);

// Root mean square distance over the picture between where two homographies put its points, px.
double HomographyRms(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, int width, int height);

}  // namespace windhover
