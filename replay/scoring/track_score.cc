// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/track_score.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace windhover::replay {
namespace {

constexpr std::int64_t kNoTrack = -1;

struct Object {
  std::int64_t track = kNoTrack;  // of the detection that it had last
  bool found = false;             // in the frame in which it was last labelled
};

using Objects = std::map<std::int64_t, Object>;

bool HasIdentities(const FrameBoxes& frame) {
  return std::all_of(frame.truth.begin(), frame.truth.end(),
                     [](const LabelledBox& box) { return box.score == 0 || box.id >= 0; }) &&
         std::all_of(frame.detections.begin(), frame.detections.end(),
                     [](const LabelledBox& box) { return box.id >= 0; });
}

// Pairs of objects with their last tracks that the rule still allows. An id that comes twice in one
// frame goes with its first box.
std::vector<FramePair> KeptPairs(const FrameBoxes& frame, const Objects& objects,
                                 const HitRule& rule) {
  std::vector<FramePair> kept;
  std::vector<bool> taken(frame.detections.size(), false);
  for (std::size_t t = 0; t < frame.truth.size(); ++t) {
    const LabelledBox& box = frame.truth[t];
    const auto object = objects.find(box.id);
    if (box.score == 0 || object == objects.end() || object->second.track == kNoTrack) continue;
    for (std::size_t d = 0; d < frame.detections.size(); ++d) {
      if (taken[d] || frame.detections[d].id != object->second.track) continue;
      if (rule.Fit(box.box, frame.detections[d].box) <= 0) continue;
      taken[d] = true;
      kept.emplace_back(static_cast<int>(t), static_cast<int>(d));
      break;
    }
  }
  return kept;
}

}  // namespace

std::optional<TrackScore> ScoreTracks(std::span<const FrameBoxes> frames, const HitRule& rule) {
  TrackScore score;
  Objects objects;
  for (const FrameBoxes& frame : frames) {
    if (!HasIdentities(frame)) return std::nullopt;
    const FrameMatch match =
        MatchFrame(frame.truth, frame.detections, rule, KeptPairs(frame, objects, rule));
    for (std::size_t t = 0; t < frame.truth.size(); ++t) {
      const int detection = match.detection_of_truth[t];
      if (detection == FrameMatch::kIgnored) continue;
      Object& object = objects[frame.truth[t].id];
      if (detection == FrameMatch::kMiss) {
        object.found = false;
        continue;
      }
      const std::int64_t track = frame.detections[detection].id;
      if (object.track != kNoTrack) {
        if (track != object.track) ++score.id_switches;
        if (!object.found) ++score.fragmentations;
      }
      object = {track, true};
    }
  }
  score.objects = static_cast<int>(objects.size());
  return score;
}

}  // namespace windhover::replay
