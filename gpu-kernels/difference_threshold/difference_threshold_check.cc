// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/difference_threshold/difference_threshold_check.h"

#include <cmath>
#include <stdexcept>

namespace windhover {

void CheckDifferenceThreshold(const GrayImage& frame, const GrayImage& background,
                              const DifferenceThresholdSettings& settings, const BitImage& seeds) {
  if (settings.threshold < 1 || settings.threshold > 255) {
    throw std::invalid_argument("difference threshold: threshold must be 1 to 255 grey levels");
  }
  if (!(settings.gradient_gain_px >= 0.0F && settings.gradient_gain_px <= 4.0F)) {
    throw std::invalid_argument("difference threshold: gradient gain must be 0 to 4 px");
  }
  const int width = frame.width();
  const int height = frame.height();
  if (frame.empty() || background.empty() || seeds.words.empty() || background.width() != width ||
      background.height() != height || seeds.width != width || seeds.height != height ||
      seeds.words.width() != (width + 31) / 32 || seeds.words.height() != height) {
    throw std::invalid_argument(
        "difference threshold: frame, background and seeds must have one size");
  }
}

int GainIn64ths(const DifferenceThresholdSettings& settings) {
  return static_cast<int>(std::lround(64.0F * settings.gradient_gain_px));
}

}  // namespace windhover
