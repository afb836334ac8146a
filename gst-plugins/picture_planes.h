// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>

namespace windhover {

// One plane of a video frame, in the memory where it lies.
struct PicturePlane {
  cv::Mat pixels;
  // Frame pixels that one of its own spans in x and y: 2 for the chroma of NV12 and I420.
  int step = 1;
  cv::Scalar black;
};

// The planes of a mapped frame of one of WINDHOVER_8_BIT_FORMATS (luma.h). `black` follows the
// range of the frame's colorimetry. Throws std::invalid_argument for other formats.
class PicturePlanes {
 public:
  explicit PicturePlanes(const GstVideoFrame& frame);

  std::size_t size() const { return count_; }
  PicturePlane& operator[](std::size_t i) { return planes_[i]; }
  const PicturePlane& operator[](std::size_t i) const { return planes_[i]; }

 private:
  std::array<PicturePlane, 3> planes_;
  std::size_t count_ = 0;
};

// A homography between two frames, told for planes of them. Centres of pixels lie at integers, and
// a chroma pixel's in the middle of the four that it spans.
Eigen::Matrix3d InPlane(const Eigen::Matrix3d& b_from_a, int step);

}  // namespace windhover
