// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu-kernels/image.h"

namespace windhover {

// Reduces a picture by a whole factor, each pixel the rounded mean of a factor x factor block.
//
// in      source, 8 bits
// out     floor(width / factor) x floor(height / factor); pixel (x, y) of it has its centre at
//         (factor * x + (factor - 1) / 2, factor * y + (factor - 1) / 2) of the source
// range   factor 1 to 16
// border  columns and rows that do not fill a block are left out
// twins   equal
// errors  wrong destination size or factor: std::invalid_argument
class Decimate {
 public:
  virtual ~Decimate() = default;
  virtual void Run(const GrayImage& source, int factor, GrayImage& destination) = 0;
};

}  // namespace windhover
