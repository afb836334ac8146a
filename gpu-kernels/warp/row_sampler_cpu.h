// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gpu-kernels/image.h"
#include "gpu-kernels/warp/warp_coefficients.h"

namespace windhover {

// Samples a picture along the rows of a grid, bilinearly: the common part of the CPU twins of the
// warp and of the phase correlation.
//
// A sample at (u, v) is seen where w > 0, 0 <= u <= width - 1 and 0 <= v <= height - 1: all source
// pixels with a share in it lie inside the picture.
class RowSampler {
 public:
  // For rows of up to `max_length` samples; grows when a longer one is asked for.
  explicit RowSampler(int max_length = 0) { Reserve(max_length); }

  // values[i] is the grey level at picture_from_grid(i, y), not rounded, and seen[i] 1; both are 0
  // where it is not seen.
  void Sample(const MappedImage<const std::uint8_t>& picture,
              const WarpCoefficients& picture_from_grid, int y, int length, float* values,
              float* seen);

 private:
  void Reserve(int length);

  std::vector<std::int32_t> offsets_;
  std::vector<float> fraction_x_;
  std::vector<float> fraction_y_;
  std::vector<std::uint16_t> upper_;
  std::vector<std::uint16_t> lower_;
};

}  // namespace windhover
