// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/trails.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "service/vision/homography.h"

namespace windhover {

void Trails::Advance(const FrameRegistration& registration,
                     const std::vector<Detection>& detections) {
  if (registration.starts_segment || registration.quality == RegistrationQuality::kLost) Reset();
  const Eigen::Matrix3d frame_from_previous = InverseHomography(registration.previous_from_frame);
  for (std::size_t i = 0; i < used_; ++i) {
    trails_[i].seen = false;
    for (Eigen::Vector2d& point : trails_[i].points) point = Project(frame_from_previous, point);
  }
  for (const Detection& detection : detections) {
    const Box& box = detection.box;
    Trail& trail = TrailOf(detection.track_id);
    trail.seen = true;
    trail.box = box;
    if (trail.points.size() >= max_points_) trail.points.erase(trail.points.begin());
    trail.points.emplace_back(box.x + 0.5 * (box.width - 1.0), box.y + 0.5 * (box.height - 1.0));
  }
  for (std::size_t i = 0; i < used_;) {
    Trail& trail = trails_[i];
    if (!trail.seen) trail.points.erase(trail.points.begin());
    if (trail.points.empty()) {
      std::swap(trail, trails_[--used_]);
    } else {
      ++i;
    }
  }
}

Trails::Trail& Trails::TrailOf(std::uint64_t track_id) {
  const auto in_use = trails_.begin() + static_cast<std::ptrdiff_t>(used_);
  const auto known = std::find_if(trails_.begin(), in_use, [track_id](const Trail& trail) {
    return trail.track_id == track_id;
  });
  if (known != in_use) return *known;
  if (used_ == trails_.size()) {
    trails_.emplace_back();
    trails_.back().points.reserve(max_points_);
  }
  Trail& trail = trails_[used_++];
  trail.track_id = track_id;
  trail.points.clear();
  return trail;
}

}  // namespace windhover
