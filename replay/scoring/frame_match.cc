// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/frame_match.h"

#include <algorithm>
#include <cmath>

namespace windhover::replay {
namespace {

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

// Pairs as many as can be by augmenting paths: a detection may push another one on to that one's
// next candidate.
class Pairing {
 public:
  // `candidates`: for each detection the truth that it may have, best first.
  Pairing(const std::vector<std::vector<int>>& candidates, FrameMatch& match)
      : candidates_(candidates), match_(match) {}

  void Place(int detection) {
    visited_.assign(match_.detection_of_truth.size(), false);
    Find(detection);
  }

 private:
  bool Find(int detection) {
    for (const int t : candidates_[detection]) {
      if (visited_[t]) continue;
      visited_[t] = true;
      const int holder = match_.detection_of_truth[t];
      if (holder == FrameMatch::kMiss || Find(holder)) {
        match_.detection_of_truth[t] = detection;
        match_.truth_of_detection[detection] = t;
        return true;
      }
    }
    return false;
  }

  const std::vector<std::vector<int>>& candidates_;
  FrameMatch& match_;
  std::vector<bool> visited_;
};

struct Candidate {
  double fit;
  int detection;
  int truth;
};

// All that the rule allows among truth that counts, best first.
std::vector<Candidate> Candidates(const std::vector<LabelledBox>& truth,
                                  const std::vector<LabelledBox>& detections, const HitRule& rule) {
  std::vector<Candidate> pairs;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (truth[t].score == 0) continue;
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const double fit = rule.Fit(truth[t].box, detections[d].box);
      if (fit > 0) pairs.push_back({fit, static_cast<int>(d), static_cast<int>(t)});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Candidate& a, const Candidate& b) { return a.fit > b.fit; });
  return pairs;
}

}  // namespace

double Overlap(const Box& a, const Box& b) {
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  if (width <= 0 || height <= 0) return 0;
  const double both = width * height;
  return both / (a.width * a.height + b.width * b.height - both);
}

double HitRule::Fit(const Box& truth, const Box& detection) const {
  if (least_overlap_ != kByCentre) {
    const double overlap = Overlap(truth, detection);
    return overlap > least_overlap_ ? overlap : 0;
  }
  const double distance =
      std::hypot(truth.x + truth.width / 2 - detection.x - detection.width / 2,
                 truth.y + truth.height / 2 - detection.y - detection.height / 2);
  const double reach = std::max(std::hypot(truth.width, truth.height) / 2, kLeastCentrePx);
  return distance <= reach ? 1 / (1 + distance) : 0;
}

FrameMatch MatchFrame(const std::vector<LabelledBox>& truth,
                      const std::vector<LabelledBox>& detections, const HitRule& rule,
                      std::span<const FramePair> kept) {
  FrameMatch match = {std::vector<int>(detections.size(), FrameMatch::kMiss),
                      std::vector<int>(truth.size(), FrameMatch::kMiss)};
  std::vector<Box> ignored;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (truth[t].score != 0) continue;
    match.detection_of_truth[t] = FrameMatch::kIgnored;
    ignored.push_back(truth[t].box);
  }
  for (const auto& [t, d] : kept) {
    match.detection_of_truth[t] = d;
    match.truth_of_detection[d] = t;
  }
  const auto is_kept = [&](const Candidate& pair) {
    return std::any_of(kept.begin(), kept.end(), [&](const FramePair& one) {
      return one.first == pair.truth || one.second == pair.detection;
    });
  };
  std::vector<bool> has_candidate(detections.size(), false);
  std::vector<std::vector<int>> candidates(detections.size());
  std::vector<Candidate> pairs = Candidates(truth, detections, rule);
  for (const Candidate& pair : pairs) has_candidate[pair.detection] = true;
  if (!kept.empty()) std::erase_if(pairs, is_kept);
  for (const Candidate& pair : pairs) candidates[pair.detection].push_back(pair.truth);
  Pairing pairing(candidates, match);
  for (const Candidate& pair : pairs) {
    if (match.truth_of_detection[pair.detection] == FrameMatch::kMiss) {
      pairing.Place(pair.detection);
    }
  }
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (match.truth_of_detection[d] == FrameMatch::kMiss && !has_candidate[d] &&
        CoveredShare(detections[d].box, ignored) >= kIgnoredShare) {
      match.truth_of_detection[d] = FrameMatch::kIgnored;
    }
  }
  return match;
}

FrameMatch MatchFrame(const std::vector<LabelledBox>& truth,
                      const std::vector<LabelledBox>& detections, double least_overlap) {
  return MatchFrame(truth, detections, HitRule::ByOverlap(least_overlap));
}

}  // namespace windhover::replay
