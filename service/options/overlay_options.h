// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service/options/option.h"

namespace windhover {

// What is drawn on the video for people.
struct OverlayOptions {
  bool boxes = true;
  bool ids = true;
  bool trails = true;
  int trail_frames = 60;
  bool status = true;

  static constexpr auto Fields() {
    using O = OverlayOptions;
    return std::make_tuple(
        Flag("boxes", &O::boxes, "Draw a box around each detection"),
        Flag("ids", &O::ids, "Write each detection's track number beside it"),
        Flag("trails", &O::trails,
             "Draw the way that each track has come, as it lies on the ground"),
        Number("trail-frames", &O::trail_frames, 2, 1000, "frames", "Length of the trails"),
        Flag("status", &O::status,
             "Write the frame number and the registration's quality at the lower border"));
  }
};

}  // namespace windhover
