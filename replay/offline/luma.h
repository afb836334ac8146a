// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "gpu-kernels/image.h"

namespace windhover::replay {

// The luma of `frame`, CV_8UC3 with blue first, into `gray` of the same size. `luma` is memory that
// is kept from frame to frame.
void CopyLuma(const cv::Mat& frame, cv::Mat& luma, GrayImage& gray);

}  // namespace windhover::replay
