// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/warp/warp_coefficients.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace windhover {

WarpCoefficients MakeWarpCoefficients(const Matrix3& source_from_destination) {
  const Matrix3& m = source_from_destination;
  double largest = 0.0;
  for (int i = 0; i < 9; ++i) {
    if (!std::isfinite(m[i])) throw std::invalid_argument("warp: the matrix is not finite");
    largest = std::max(largest, std::abs(m[i]));
  }
  // Homographies between pictures have w near 1 and are left as they are; only scales that single
  // precision could not hold are changed.
  const double scale = largest > 1e6 || (largest > 0.0 && largest < 1e-2) ? 1.0 / largest : 1.0;
  WarpCoefficients result;
  for (int i = 0; i < 9; ++i) result[i] = static_cast<float>(m[i] * scale);
  return result;
}

Matrix3 WithOrigin(const Matrix3& source_from_destination, double x, double y) {
  Matrix3 m = source_from_destination;
  for (int row = 0; row < 3; ++row) m[3 * row + 2] += m[3 * row] * x + m[3 * row + 1] * y;
  return m;
}

}  // namespace windhover
