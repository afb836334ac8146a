// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/benchmarks/figures.h"
#include "replay/format/labels.h"

namespace windhover::replay {

// Whether people are shown this frame, which counts from 0, of so many: one at a third of the way
// and one at two thirds.
bool IsSample(int frame, int frames);

// What one contestant has detected in the whole sequence.
struct SampleView {
  std::string title;
  std::vector<LabelledBox> boxes;
};

// `frame` counts from 1; `picture` is CV_8UC3. Hits are those at kThesisOverlap; what is ignored
// (FrameMatch) has no mark.
SampleFrame MakeSample(const std::string& sequence, int frame, const cv::Mat& picture,
                       const std::vector<LabelledBox>& truth, const std::vector<SampleView>& views);

}  // namespace windhover::replay
