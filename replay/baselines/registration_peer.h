// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace windhover::replay {

// A registration that ours is compared with. Registers the frames of a video one after the other,
// each to the one before; what it has computed for a frame may serve for the next one, too.
class RegistrationPeer {
 public:
  virtual ~RegistrationPeer() = default;

  // `gray` is CV_8UC1, always of one size. Returns previous_from_frame with h33 = 1; nothing for
  // the first frame and where it finds none.
  virtual std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) = 0;

  // The next frame is a first one.
  virtual void Reset() = 0;
};

// first_from_second of two pictures of the peer's size that need not follow each other.
inline std::optional<Eigen::Matrix3d> RegisterPair(RegistrationPeer& peer, const cv::Mat& first,
                                                   const cv::Mat& second) {
  peer.Reset();
  peer.Register(first);
  return peer.Register(second);
}

// The homography b_from_a by RANSAC from points that are seen in both pictures: an inlier lies
// within `ransac_px` of where it belongs. Nothing for less than four points, where RANSAC finds
// none, and where h33 is 0.
std::optional<Eigen::Matrix3d> RansacHomography(const std::vector<cv::Point2f>& in_a,
                                                const std::vector<cv::Point2f>& in_b,
                                                double ransac_px);

}  // namespace windhover::replay
