// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

namespace windhover::replay {

// A homography is known up to its factor. With norm 1 and positive determinant, as here, all of the
// ground that lies before both cameras gets a positive third coordinate: they see the plane from
// one side.
inline Eigen::Matrix3d Oriented(const Eigen::Matrix3d& b_from_a) {
  return b_from_a * std::copysign(1 / b_from_a.norm(), b_from_a.determinant());
}

}  // namespace windhover::replay
