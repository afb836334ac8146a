// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "gpu-kernels/matrix3.h"

namespace windhover {

// A homography in single precision, row-major: what the kernels work with. Very large and very
// small matrices are scaled to what single precision holds, by a positive factor, so that the sign
// of w stays.
using WarpCoefficients = std::array<float, 9>;

// Throws std::invalid_argument where an element is not finite.
WarpCoefficients MakeWarpCoefficients(const Matrix3& source_from_destination);

// The same homography for a destination whose origin lies at (x, y) of the original one.
Matrix3 WithOrigin(const Matrix3& source_from_destination, double x, double y);

}  // namespace windhover
