// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/temporal_median/temporal_median_check.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace windhover {

int CheckTemporalMedian(std::span<const GrayImage* const> frames, int min_samples,
                        const GrayImage& median) {
  if (frames.empty() || frames.size() > kMaxMedianFrames) {
    throw std::invalid_argument("temporal median of " + std::to_string(frames.size()) +
                                " frames: must be 1 to 255");
  }
  for (const GrayImage* frame : frames) {
    if (frame == nullptr || frame->empty() || median.empty() || frame->width() != median.width() ||
        frame->height() != median.height()) {
      throw std::invalid_argument("temporal median: all frames and the result must have one size");
    }
  }
  return std::max(min_samples, 1);
}

}  // namespace windhover
