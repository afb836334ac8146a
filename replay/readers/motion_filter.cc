// SPDX-License-Identifier: Apache-2.0
#include "replay/readers/motion_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "service/vision/homography.h"

namespace windhover::replay {
namespace {

// One object's labels that count, by frame.
using Track = std::vector<Label*>;

Eigen::Vector2d Middle(const Box& box) {
  // Pixel centres are whole numbers: a box that covers pixel 0 only has its middle at 0.
  return {box.x + (box.width - 1) / 2, box.y + (box.height - 1) / 2};
}

class Filter {
 public:
  Filter(const Recording& recording, const GroundMotion& motion, const MotionFilterOptions& options)
      : recording_(recording), motion_(motion), options_(options) {}

  // Whether each label of the track moves; nothing where that cannot be told.
  std::vector<std::optional<bool>> Judge(const Track& track) const {
    std::vector<std::optional<bool>> judged;
    for (const Label* label : track) {
      judged.push_back(IsCut(*label) ? std::nullopt : Moves(track, label->box.frame));
    }
    return judged;
  }

  bool IsCut(const Label& label) const {
    const Box& box = label.box.box;
    return label.truncated || box.x < options_.border_px || box.y < options_.border_px ||
           box.x + box.width > recording_.width - options_.border_px ||
           box.y + box.height > recording_.height - options_.border_px;
  }

 private:
  std::optional<bool> Moves(const Track& track, int frame) const {
    const int last = track.back()->box.frame;
    const int start = std::max(track.front()->box.frame,
                               std::min(frame - options_.frames / 2, last - options_.frames));
    const Label* from = nullptr;
    const Label* to = nullptr;
    for (const Label* label : track) {
      const int at = label->box.frame;
      if (at < start || at > start + options_.frames || IsCut(*label) ||
          motion_.segment[at - 1] != motion_.segment[frame - 1]) {
        continue;
      }
      if (from == nullptr) from = label;
      to = label;
    }
    if (from == nullptr) return std::nullopt;
    const int span = to->box.frame - from->box.frame;
    if (2 * span < options_.frames) return std::nullopt;
    const double distance = (PlaceIn(frame, *to) - PlaceIn(frame, *from)).norm();
    return distance > options_.distance_px * span / options_.frames;
  }

  // Where the ground under the label's middle lies in another frame.
  Eigen::Vector2d PlaceIn(int frame, const Label& label) const {
    const Eigen::Matrix3d frame_from_label = motion_.first_from_frame[frame - 1].inverse() *
                                             motion_.first_from_frame[label.box.frame - 1];
    return Project(frame_from_label, Middle(label.box.box));
  }

  const Recording& recording_;
  const GroundMotion& motion_;
  const MotionFilterOptions& options_;
};

// The verdict on the frame nearest to `index` that has one.
std::optional<bool> Nearest(const Track& track, const std::vector<std::optional<bool>>& judged,
                            std::size_t index) {
  std::optional<bool> nearest;
  int distance = 0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (!judged[i]) continue;
    const int away = std::abs(track[i]->box.frame - track[index]->box.frame);
    if (nearest && away >= distance) continue;
    nearest = judged[i];
    distance = away;
  }
  return nearest;
}

}  // namespace

void FilterMovers(Recording& recording, const GroundMotion& motion,
                  const MotionFilterOptions& options) {
  if (recording.labels_move || recording.labels.empty()) return;
  std::map<std::int64_t, Track> tracks;
  int without_identity = 0;
  for (Label& label : recording.labels) {
    if (label.box.score == 0) continue;
    if (label.box.frame > static_cast<int>(motion.first_from_frame.size())) {
      throw std::invalid_argument("a label is of frame " + std::to_string(label.box.frame) +
                                  ", but the camera's motion is known for " +
                                  std::to_string(motion.first_from_frame.size()) + " frames");
    }
    if (label.box.id < 0) {
      label.box.score = 0;
      ++without_identity;
      continue;
    }
    tracks[label.box.id].push_back(&label);
  }
  const Filter filter(recording, motion, options);
  for (auto& [id, track] : tracks) {
    std::stable_sort(track.begin(), track.end(),
                     [](const Label* a, const Label* b) { return a->box.frame < b->box.frame; });
    const std::vector<std::optional<bool>> judged = filter.Judge(track);
    for (std::size_t i = 0; i < track.size(); ++i) {
      std::optional<bool> moves = judged[i];
      if (filter.IsCut(*track[i])) moves = Nearest(track, judged, i);
      if (!moves.value_or(false)) track[i]->box.score = 0;
    }
  }
  recording.labels_move = true;
  if (without_identity > 0) {
    recording.notes.push_back(std::to_string(without_identity) +
                              " labels have no identity: whether they move cannot be told");
  }
}

}  // namespace windhover::replay
