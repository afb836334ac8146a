// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "replay/format/labels.h"

namespace windhover::replay {

// Thesis 6.6: a low overlap, because a pixel is much of a small object.
inline constexpr double kThesisOverlap = 0.05;
// Of a detection's own area: see FrameMatch.
inline constexpr double kIgnoredShare = 0.5;

// Area of the intersection over area of the union.
double Overlap(const Box& a, const Box& b);

// When a detection may be paired with an object.
class HitRule {
 public:
  // Intersection over union above `least_overlap`; the larger it is, the better.
  static HitRule ByOverlap(double least_overlap) { return HitRule(least_overlap); }
  // The middle of the detection lies no farther from the middle of the object's box than half of
  // that box's diagonal, or kLeastCentrePx where that is more; the closer, the better. The size of
  // the detection does not matter. The field's fixed distances are each for objects of one size:
  // 3 px for targets of a few pixels (Li et al., "Dense Nested Attention Network for Infrared Small
  // Target Detection", IEEE TIP 2023), 20 px for cars of about that length (LaLonde et al.,
  // "ClusterNet", CVPR 2018). Half a diagonal is no farther than the object reaches.
  static HitRule ByCentre() { return HitRule(kByCentre); }
  static constexpr double kLeastCentrePx = 3.0;

  // How well they fit, above 0; 0: not at all.
  double Fit(const Box& truth, const Box& detection) const;

 private:
  static constexpr double kByCentre = -1;
  explicit HitRule(double least_overlap) : least_overlap_(least_overlap) {}

  double least_overlap_;
};

// What became of the boxes of one frame. Detections and truth are paired one to one, as many as can
// be where the rule allows a pair; among equally many, pairs that fit well are sought first. Truth
// of score 0 does not count. A detection is ignored where it has no partner, the rule allows it
// none that counts (else it is a duplicate, a false alarm), and at least kIgnoredShare of its own
// area lies on truth that does not count.
struct FrameMatch {
  static constexpr int kMiss = -1;      // no partner
  static constexpr int kIgnored = -2;   // does not count
  std::vector<int> truth_of_detection;  // index into the frame's truth
  std::vector<int> detection_of_truth;  // index into the frame's detections
};

// (index of truth, index of detection)
using FramePair = std::pair<int, int>;

// `kept` are pairs to be made before all others; each box is in one of them at most.
FrameMatch MatchFrame(const std::vector<LabelledBox>& truth,
                      const std::vector<LabelledBox>& detections, const HitRule& rule,
                      std::span<const FramePair> kept = {});
// By overlap.
FrameMatch MatchFrame(const std::vector<LabelledBox>& truth,
                      const std::vector<LabelledBox>& detections, double least_overlap);

}  // namespace windhover::replay
