// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "gpu-kernels/temporal_median/temporal_median.h"

namespace windhover {

inline constexpr int kMaxMedianFrames = 255;

// Throws std::invalid_argument where sizes differ or the count of frames is out of range. Returns
// `min_samples`, at least 1: a pixel that no frame has seen is 0 in any case.
int CheckTemporalMedian(std::span<const GrayImage* const> frames, int min_samples,
                        const GrayImage& median);

}  // namespace windhover
