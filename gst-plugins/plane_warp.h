// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace windhover {

// What becomes of pixels of the destination where there is no source.
enum class Outside {
  kFill,       // a given value
  kReplicate,  // the nearest pixel of the source
  kKeep,       // they are left as they are
};

// Draws `source` at destination_from_source (px, centres of pixels at integers), bilinearly, to
// 1/256 px. Both are of the same type, CV_8UC1 to CV_8UC4, and no memory of theirs overlaps. The
// source reaches to the centres of its border pixels. Own code, because cv::warpPerspective
// allocates some memory with every call.
void WarpPlane(const cv::Mat& source, const Eigen::Matrix3d& destination_from_source,
               Outside outside, const cv::Scalar& fill, cv::Mat& destination);

}  // namespace windhover
