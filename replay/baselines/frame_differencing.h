// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "replay/baselines/motion_peer.h"

namespace windhover::replay {

// The simple detector of thesis figure 6.3: the frame before is laid over the frame by their
// homography; where the two differ by at least a threshold, something moves; morphology and
// connected components make objects of that.
class FrameDifferencing : public MotionPeer {
 public:
  // Of `background` the threshold counts, of `motion` the extraction.
  FrameDifferencing(const BackgroundOptions& background, const MotionOptions& motion);

  std::vector<MovingObject> Detect(const cv::Mat& gray,
                                   const FrameRegistration& registration) override;

 private:
  int threshold_;
  MotionOptions motion_;
  cv::Mat previous_;
};

// Pixels of the frame (255, others 0) that differ by at least `threshold` grey levels from the
// frame before, laid over it. Where that shows no ground, nothing differs.
cv::Mat DifferenceMap(const cv::Mat& gray, const cv::Mat& previous,
                      const Eigen::Matrix3d& previous_from_frame, int threshold);

}  // namespace windhover::replay
