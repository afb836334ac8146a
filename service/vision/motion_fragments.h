// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "service/vision/motion_window.h"

namespace windhover {

// A component of seeds that moves, on the grid.
struct MotionFragment {
  // Pixels left <= x <= right, top <= y <= bottom.
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  Eigen::Vector2f velocity_px = Eigen::Vector2f::Zero();  // px a frame
  int object = 0;  // set by JoinFragments: fragments of one object have the same number
};

// Where the fragments are: the window and its background, on one grid.
struct FragmentSurroundings {
  std::span<const WindowSample> window;
  std::size_t centre = 0;
  GrayView background;
};

// Finds the fragments that belong to one object. Between the bright ends of a dark car, or inside
// anything long, the background may not differ enough for seeds, so that one object comes in pieces
// further apart than dilation should reach: it would join neighbouring cars.
//
// Two fragments are joined where they move alike and one behind the other, their gap is not
// much longer than they are, and what lies in the gap is not the resting background but moves
// with them: the centre frame's patches along it differ from the background and are found again in
// other frames where the motion takes them. Where a patch fits both, as between dark roof and dark
// road, they are joined only if together they have the shape of one vehicle.
//
// `object` becomes the index of the first fragment of the same object.
void JoinFragments(const FragmentSurroundings& around, std::vector<MotionFragment>& fragments);

}  // namespace windhover
