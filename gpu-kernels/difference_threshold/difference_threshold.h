// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu-kernels/image.h"

namespace windhover {

struct DifferenceThresholdSettings {
  // Grey levels by which a pixel must differ from the background, 1 to 255.
  int threshold = 20;
  // Added for each grey level per px of the background's gradient: the registration's local error
  // in px that the threshold forgives, 0 to 4.
  float gradient_gain_px = 0.0F;
};

// Marks motion seeds: pixels where a registered frame differs from the background (thesis 6.3).
//
// in      frame and background of one size; 0 in either means "no ground seen"
// out     one bit a pixel: |frame - background| > threshold + gradient_gain_px * g, where g is the
//         larger of |b(x+1) - b(x-1)| / 2 and |b(y+1) - b(y-1)| / 2 of the background. Not a seed
//         where frame or background is 0. Where a neighbour lies outside or is 0, its difference
//         counts as 0.
// twins   equal where gradient_gain_px is a multiple of 1/64; it is rounded to that.
// errors  sizes that differ, settings out of range: std::invalid_argument
class DifferenceThreshold {
 public:
  virtual ~DifferenceThreshold() = default;
  virtual void Run(const GrayImage& frame, const GrayImage& background,
                   const DifferenceThresholdSettings& settings, BitImage& seeds) = 0;
};

}  // namespace windhover
