// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/format/labels.h"

namespace windhover::replay {

// Draws the boxes of one frame: green where a detection hits truth, red where it does not, yellow
// where truth was missed. Without truth (null) every detection is green. `caption` goes into the
// corner.
void DrawBoxes(cv::Mat& frame, const std::vector<LabelledBox>& detections,
               const std::vector<LabelledBox>* truth, const std::string& caption);

}  // namespace windhover::replay
