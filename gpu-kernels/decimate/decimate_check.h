// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "gpu-kernels/decimate/decimate.h"

namespace windhover {

inline constexpr int kMaxDecimation = 16;

// Throws std::invalid_argument where the factor is out of range or the destination's size wrong.
inline void CheckDecimate(const GrayImage& source, int factor, const GrayImage& destination) {
  if (factor < 1 || factor > kMaxDecimation) {
    throw std::invalid_argument("decimation by " + std::to_string(factor) +
                                ": the factor must be 1 to 16");
  }
  if (source.empty() || destination.empty() || destination.width() != source.width() / factor ||
      destination.height() != source.height() / factor) {
    throw std::invalid_argument("decimation: the destination must have the source's size over " +
                                std::to_string(factor));
  }
}

}  // namespace windhover
