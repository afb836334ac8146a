// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/motion_score.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

namespace windhover::replay {
namespace {

std::optional<double> Ratio(double part, double whole) {
  if (whole == 0) return std::nullopt;
  return part / whole;
}

}  // namespace

std::optional<double> MotionScore::precision() const { return Ratio(hits, detections); }
std::optional<double> MotionScore::recall() const { return Ratio(hits, truth); }
std::optional<double> MotionScore::f1() const { return Ratio(2.0 * hits, truth + detections); }

double Overlap(const Box& a, const Box& b) {
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  if (width <= 0 || height <= 0) return 0;
  const double both = width * height;
  return both / (a.width * a.height + b.width * b.height - both);
}

FrameMatch MatchFrame(const std::vector<LabelledBox>& truth,
                      const std::vector<LabelledBox>& detections, double least_overlap) {
  struct Pair {
    double overlap;
    int detection;
    int truth;
  };
  FrameMatch match = {std::vector<int>(detections.size(), FrameMatch::kMiss),
                      std::vector<int>(truth.size(), FrameMatch::kMiss)};
  std::vector<Pair> pairs;
  std::vector<bool> ignorable(detections.size());
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (truth[t].score == 0) match.detection_of_truth[t] = FrameMatch::kIgnored;
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const double overlap = Overlap(truth[t].box, detections[d].box);
      if (overlap <= least_overlap) continue;
      if (truth[t].score == 0) {
        ignorable[d] = true;
      } else {
        pairs.push_back({overlap, static_cast<int>(d), static_cast<int>(t)});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.overlap > b.overlap; });
  std::vector<std::vector<int>> candidates(detections.size());
  for (const Pair& pair : pairs) candidates[pair.detection].push_back(pair.truth);
  // Augmenting paths: a detection may push another one on to its next candidate.
  std::vector<bool> visited;
  const std::function<bool(int)> place = [&](int detection) {
    for (const int t : candidates[detection]) {
      if (visited[t]) continue;
      visited[t] = true;
      const int holder = match.detection_of_truth[t];
      if (holder == FrameMatch::kMiss || place(holder)) {
        match.detection_of_truth[t] = detection;
        match.truth_of_detection[detection] = t;
        return true;
      }
    }
    return false;
  };
  for (const Pair& pair : pairs) {
    if (match.truth_of_detection[pair.detection] != FrameMatch::kMiss) continue;
    visited.assign(truth.size(), false);
    place(pair.detection);
  }
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (match.truth_of_detection[d] == FrameMatch::kMiss && ignorable[d]) {
      match.truth_of_detection[d] = FrameMatch::kIgnored;
    }
  }
  return match;
}

MotionScore ScoreMotion(const std::vector<LabelledBox>& truth,
                        const std::vector<LabelledBox>& detections, double least_overlap) {
  struct Frame {
    std::vector<LabelledBox> truth;
    std::vector<LabelledBox> detections;
  };
  std::map<int, Frame> frames;
  for (const LabelledBox& box : truth) frames[box.frame].truth.push_back(box);
  for (const LabelledBox& box : detections) frames[box.frame].detections.push_back(box);
  MotionScore score;
  for (const auto& [number, frame] : frames) {
    const FrameMatch match = MatchFrame(frame.truth, frame.detections, least_overlap);
    for (const int detection : match.detection_of_truth) {
      if (detection != FrameMatch::kIgnored) ++score.truth;
    }
    for (const int partner : match.truth_of_detection) {
      if (partner != FrameMatch::kIgnored) ++score.detections;
      if (partner >= 0) ++score.hits;
    }
  }
  return score;
}

}  // namespace windhover::replay
