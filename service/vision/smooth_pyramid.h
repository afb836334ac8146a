// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gpu-kernels/image.h"

namespace windhover {

// A picture whose values are no longer whole grey levels. Rows follow each other without padding.
struct FloatPicture {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

// A picture at several resolutions, each smoothed by the binomial filter (1 4 6 4 1) / 16 in both
// directions, so that linear interpolation between its pixels is exact enough for direct
// registration. Level 0 has the picture's size; each further level takes every second pixel of the
// one below it, from the first on: pixel x of level l lies at 2^l x of the picture. Keeps its
// memory for the next picture.
class SmoothPyramid {
 public:
  void Build(const GrayImage& picture, int levels);

  const FloatPicture& level(int index) const { return levels_[index]; }

 private:
  std::vector<FloatPicture> levels_;
  std::vector<float> row_;
};

}  // namespace windhover
