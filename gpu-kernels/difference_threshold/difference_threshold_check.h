// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu-kernels/difference_threshold/difference_threshold.h"

namespace windhover {

// Throws std::invalid_argument where sizes differ or settings are out of range.
void CheckDifferenceThreshold(const GrayImage& frame, const GrayImage& background,
                              const DifferenceThresholdSettings& settings, const BitImage& seeds);

// gradient_gain_px in units of 1/64 px, rounded: 0 to 256.
int GainIn64ths(const DifferenceThresholdSettings& settings);

}  // namespace windhover
