// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace windhover {

// What shows how well picture a lies on picture b: grey pictures of 8 bits, in the coordinates of
// b.
struct PairPictures {
  // Colour: a in red, b in cyan. What agrees is grey, what does not has coloured edges. Where a
  // sees nothing there is b alone, dark.
  cv::Mat blended;
  // |gain a + offset - b| where both see the ground, 0 elsewhere. Gain and offset give both the
  // same mean and standard deviation there.
  cv::Mat difference;
};

PairPictures CompareAligned(const cv::Mat& a, const cv::Mat& b, const Eigen::Matrix3d& b_from_a);

}  // namespace windhover
