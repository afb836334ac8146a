// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/frame_outcome.h"

#include <Eigen/LU>
#include <stdexcept>

#include "service/gstreamer/detection_meta.h"
#include "service/gstreamer/homography_meta.h"

namespace windhover::replay {

FrameOutcome OutcomeOf(GstBuffer* buffer) {
  const GstWindhoverHomographyMeta* meta = gst_buffer_get_windhover_homography_meta(buffer);
  if (meta == nullptr) throw std::runtime_error("a frame left the pipeline without registration");
  FrameOutcome outcome = {meta->registration, {}, meta->width, meta->height};
  GetDetections(buffer, outcome.width, outcome.height, outcome.detections);
  return outcome;
}

std::vector<Eigen::Matrix3d> FirstFromFrame(const std::vector<FrameOutcome>& outcomes) {
  std::vector<Eigen::Matrix3d> composed;
  for (const FrameOutcome& outcome : outcomes) {
    if (composed.empty()) {
      composed.push_back(Eigen::Matrix3d::Identity());
      continue;
    }
    Eigen::Matrix3d next = composed.back() * outcome.registration.previous_from_frame;
    next /= next(2, 2);
    composed.push_back(next);
  }
  return composed;
}

std::vector<LabelledBox> BoxesOf(const std::vector<FrameOutcome>& outcomes) {
  std::vector<LabelledBox> boxes;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    for (const Detection& detection : outcomes[i].detections) {
      boxes.push_back({static_cast<int>(i) + 1, static_cast<std::int64_t>(detection.track_id),
                       detection.box, detection.score});
    }
  }
  return boxes;
}

}  // namespace windhover::replay
