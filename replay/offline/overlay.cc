// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/overlay.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "replay/scoring/motion_score.h"

namespace windhover::replay {
namespace {

const cv::Scalar kHit(60, 220, 60);
const cv::Scalar kFalseAlarm(50, 50, 240);
const cv::Scalar kMiss(40, 220, 250);

void DrawBox(cv::Mat& frame, const LabelledBox& box, const cv::Scalar& colour) {
  const cv::Point low(static_cast<int>(std::floor(box.box.x)) - 1,
                      static_cast<int>(std::floor(box.box.y)) - 1);
  const cv::Point high(static_cast<int>(std::ceil(box.box.x + box.box.width)),
                       static_cast<int>(std::ceil(box.box.y + box.box.height)));
  cv::rectangle(frame, low, high, colour, 1);
  if (box.id < 0) return;
  cv::putText(frame, std::to_string(box.id), {high.x + 2, low.y + 7}, cv::FONT_HERSHEY_PLAIN, 0.7,
              colour, 1, cv::LINE_AA);
}

}  // namespace

void DrawBoxes(cv::Mat& frame, const std::vector<LabelledBox>& detections,
               const std::vector<LabelledBox>* truth, const std::string& caption) {
  const FrameMatch match =
      truth != nullptr ? MatchFrame(*truth, detections, kThesisOverlap) : FrameMatch{};
  for (std::size_t i = 0; truth != nullptr && i < truth->size(); ++i) {
    if (match.detection_of_truth[i] != FrameMatch::kMiss) continue;
    LabelledBox missed = (*truth)[i];
    missed.id = -1;
    DrawBox(frame, missed, kMiss);
  }
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const bool alarm = truth != nullptr && match.truth_of_detection[i] == FrameMatch::kMiss;
    DrawBox(frame, detections[i], alarm ? kFalseAlarm : kHit);
  }
  cv::putText(frame, caption, {4, frame.rows - 6}, cv::FONT_HERSHEY_PLAIN, 1.0,
              cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
}

}  // namespace windhover::replay
