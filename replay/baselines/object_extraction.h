// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/options/options.h"
#include "service/vision/types.h"

namespace windhover::replay {

struct MovingObject {
  Box box;
  int area_px = 0;  // pixels that differ
};

// Objects from a map of pixels that differ (CV_8UC1, not 0), with OpenCV: erosion, dilation,
// components of eight neighbours, a box around the given pixels of each. The options' radii, least
// area and largest size mean what they do in our own extraction, so that both can be compared
// (thesis 6.6: "the same parameter settings ... for extraction of objects").
std::vector<MovingObject> ExtractObjects(const cv::Mat& map, const MotionOptions& options);

}  // namespace windhover::replay
