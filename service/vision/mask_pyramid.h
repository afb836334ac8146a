// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu-kernels/image.h"

namespace windhover {

// Which pixels of a SmoothPyramid's levels come of pixels that a mask lets take part, and of no
// other: the rest has been smoothed together with what the mask leaves out. Keeps its memory.
class MaskPyramid {
 public:
  // Pixels where the mask is not 0 take part; all do where there is none.
  void Build(const GrayImage* mask, int levels);

  // Row by row, 1 where a pixel takes part and 0 elsewhere; empty where there is no mask.
  std::span<const std::uint8_t> level(int index) const { return levels_[index]; }

 private:
  std::vector<std::vector<std::uint8_t>> levels_;
  std::vector<std::uint8_t> all_;
  std::vector<std::uint8_t> across_;
};

}  // namespace windhover
