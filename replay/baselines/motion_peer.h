// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "replay/baselines/object_extraction.h"
#include "service/vision/types.h"

namespace windhover::replay {

// A motion detection that ours is compared with. It is given our registration: the thesis compares
// with the same one on both sides (6.6).
class MotionPeer {
 public:
  virtual ~MotionPeer() = default;

  // What moves in a frame, in its coordinates. Frames come one after the other; `gray` is CV_8UC1,
  // always of one size. Nothing where `registration` starts a segment.
  virtual std::vector<MovingObject> Detect(const cv::Mat& gray,
                                           const FrameRegistration& registration) = 0;
};

}  // namespace windhover::replay
