// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <opencv2/video/background_segm.hpp>

#include "replay/baselines/motion_peer.h"

namespace windhover::replay {

// A still camera's background subtraction (OpenCV's MOG2, a mixture of Gaussians for each pixel)
// on a canvas over which the frames are laid by their homographies. The canvas reaches over its
// first frame by half a picture on each side. When the camera leaves it, a new one is laid and
// taught the last frames at once.
class StabilizedMog2 : public MotionPeer {
 public:
  // Of `motion` the extraction counts.
  explicit StabilizedMog2(const MotionOptions& motion) : motion_(motion) {}

  std::vector<MovingObject> Detect(const cv::Mat& gray,
                                   const FrameRegistration& registration) override;

 private:
  struct HeldFrame {
    cv::Mat gray;
    Eigen::Matrix3d next_from_frame = Eigen::Matrix3d::Identity();
  };

  void LayCanvas(const cv::Mat& gray);
  bool IsOnCanvas() const;
  void Teach(const cv::Mat& gray, const Eigen::Matrix3d& canvas_from_frame);

  MotionOptions motion_;
  cv::Ptr<cv::BackgroundSubtractorMOG2> model_;
  Eigen::Matrix3d canvas_from_frame_ = Eigen::Matrix3d::Identity();  // of the last frame
  cv::Mat canvas_;      // CV_8UC1, what was seen of each pixel last
  cv::Mat times_seen_;  // CV_8UC1, of each pixel, in frames
  cv::Mat foreground_;  // CV_8UC1
  std::deque<HeldFrame> held_;
};

}  // namespace windhover::replay
