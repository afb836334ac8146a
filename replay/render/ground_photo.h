// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "replay/render/scene.h"

namespace windhover::replay {

// A picture of real ground, laid flat on the map with its middle at (0, 0), mirrored beyond its
// edges again and again.
class GroundPhoto {
 public:
  // CV_8UC3, blue first, at least 2x2 px; `pixel_m` metres a pixel. std::invalid_argument
  // otherwise.
  GroundPhoto(const cv::Mat& picture, double pixel_m);

  // Mean colour around a spot of the map, m, for texels of this size.
  Colour At(double x, double y, double texel_m) const;

 private:
  std::vector<cv::Mat> levels_;  // each half the size of the one before
  double pixel_m_;
};

}  // namespace windhover::replay
