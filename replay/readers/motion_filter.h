// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "replay/readers/ground_motion.h"
#include "replay/readers/recording.h"

namespace windhover::replay {

// When a labelled object counts as moving in a frame.
struct MotionFilterOptions {
  // It travels more than `distance_px` against the ground within `frames` frames around that one
  // (those that it has, at the ends of its track), in px of that frame. A track of fewer frames
  // must travel its share of it, and one of less than half of them cannot be judged. By these
  // defaults 532 of 537 boxes of a slow car (UAVDT's S1301) move, 201 of 201 of a walker (UAV123's
  // person12), and 2 of 160 of a building under which the ground slides by parallax (UAV123's
  // building4).
  double distance_px = 10.0;
  int frames = 30;
  // Boxes this close to the picture's border are cut off by it and say nothing of where the
  // object's middle is; such a frame is judged as the nearest one of the same object.
  double border_px = 2.0;
};

// Leaves the labels that move to count and makes the others not count (score 0): objects that
// stand, that were seen too briefly, and those without identity. Where an object is at each time
// says the middle of its box; camera motion is taken out by `motion`. A recording whose labels are
// sure to move stays as it is. Throws std::invalid_argument where `motion` is of fewer frames than
// the labels.
void FilterMovers(Recording& recording, const GroundMotion& motion,
                  const MotionFilterOptions& options = {});

}  // namespace windhover::replay
