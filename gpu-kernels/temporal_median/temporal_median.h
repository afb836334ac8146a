// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "gpu-kernels/image.h"

namespace windhover {

// Pixel-wise median over the registered frames of a window: the background (thesis 6.3).
//
// in      1 to 255 registered frames of one size; 0 means "no ground seen" and does not take part
// out     the lower median of the values that take part; 0 where fewer than `min_samples` do
// twins   equal
// errors  sizes that differ, no frame, too many: std::invalid_argument
class TemporalMedian {
 public:
  virtual ~TemporalMedian() = default;
  virtual void Run(std::span<const GrayImage* const> frames, int min_samples,
                   GrayImage& median) = 0;
};

}  // namespace windhover
