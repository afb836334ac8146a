// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu-kernels/image.h"
#include "gpu-kernels/matrix3.h"

namespace windhover {

// Warps a picture by a homography with bilinear interpolation.
//
// in      source, any size, 8 bits
// out     destination, any size; pixel x takes the source at source_from_destination(x)
// border  a destination pixel whose source neighbours do not all lie inside the source, or whose
//         homogeneous w is not positive, becomes 0: "no ground seen". Neighbours are the up to four
//         pixels with a share in the result: the border pixels' centres are still inside. Seen
//         pixels are at least 1, so that the two never mix; black (0) becomes 1.
// twins   agree within 1 grey level; on at most 0.1 % of the pixels (coordinates that fall within
//         rounding of the border) one may be 0 and the other not.
// errors  non-finite matrix, one image as source and destination: std::invalid_argument
class Warp {
 public:
  virtual ~Warp() = default;
  virtual void Run(const GrayImage& source, const Matrix3& source_from_destination,
                   GrayImage& destination) = 0;
};

}  // namespace windhover
