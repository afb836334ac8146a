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

// Area of `box` that lies on any of `others`, over its own.
double CoveredShare(const Box& box, const std::vector<Box>& others) {
  std::vector<Box> pieces;  // what they cover, which may overlap
  std::vector<double> edges;
  for (const Box& other : others) {
    const double left = std::max(box.x, other.x);
    const double right = std::min(box.x + box.width, other.x + other.width);
    const double top = std::max(box.y, other.y);
    const double bottom = std::min(box.y + box.height, other.y + other.height);
    if (left >= right || top >= bottom) continue;
    pieces.push_back({left, top, right - left, bottom - top});
    edges.insert(edges.end(), {left, right});
  }
  std::sort(edges.begin(), edges.end());
  std::sort(pieces.begin(), pieces.end(), [](const Box& a, const Box& b) { return a.y < b.y; });
  // Column by column between neighbouring edges, where the pieces' heights add up.
  double area = 0;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const double middle = (edges[i - 1] + edges[i]) / 2;
    double height = 0;
    double reached = box.y;
    for (const Box& piece : pieces) {
      if (piece.x > middle || piece.x + piece.width < middle) continue;
      const double bottom = piece.y + piece.height;
      height += std::max(0.0, bottom - std::max(reached, piece.y));
      reached = std::max(reached, bottom);
    }
    area += height * (edges[i] - edges[i - 1]);
  }
  return area / (box.width * box.height);
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
  std::vector<Box> ignored;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (truth[t].score == 0) {
      match.detection_of_truth[t] = FrameMatch::kIgnored;
      ignored.push_back(truth[t].box);
      continue;
    }
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const double overlap = Overlap(truth[t].box, detections[d].box);
      if (overlap > least_overlap) {
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
    if (candidates[d].empty() && CoveredShare(detections[d].box, ignored) >= kIgnoredShare) {
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
