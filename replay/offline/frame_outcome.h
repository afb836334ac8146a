// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "replay/format/labels.h"
#include "service/vision/types.h"

typedef struct _GstBuffer GstBuffer;

namespace windhover::replay {

// What the elements have found out about a frame.
struct FrameOutcome {
  FrameRegistration registration;
  std::vector<Detection> detections;
  int width = 0;  // of the frame, px
  int height = 0;
};

// Of a buffer that has passed whmotion. Throws std::runtime_error where it carries no registration.
FrameOutcome OutcomeOf(GstBuffer* buffer);

// first_from_frame of each frame, composed from previous_from_frame.
std::vector<Eigen::Matrix3d> FirstFromFrame(const std::vector<FrameOutcome>& outcomes);
// All detections, with their tracks as ids. Frames count from 1.
std::vector<LabelledBox> BoxesOf(const std::vector<FrameOutcome>& outcomes);

}  // namespace windhover::replay
