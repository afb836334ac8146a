// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "gpu-kernels/image.h"

namespace windhover::replay {

// Copies a CV_8UC1 picture into an image of the same size.
void CopyGray(const cv::Mat& picture, GrayImage& gray);

// The luma of `frame`, CV_8UC3 with blue first, into `gray` of the same size. `luma` is memory that
// is kept from frame to frame.
void CopyLuma(const cv::Mat& frame, cv::Mat& luma, GrayImage& gray);

}  // namespace windhover::replay
