// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace windhover {

// A 3x3 matrix, row-major. As a homography `b_from_a` it takes a point (x, y) of picture a, in px,
// to picture b: (u, v, w) = M (x, y, 1), then (u / w, v / w).
using Matrix3 = std::array<double, 9>;

inline constexpr Matrix3 kIdentity3 = {1, 0, 0, 0, 1, 0, 0, 0, 1};

}  // namespace windhover
