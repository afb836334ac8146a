// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "replay/format/labels.h"

namespace windhover::replay {

// Thesis 6.6: a low overlap, because a pixel is much of a small object.
inline constexpr double kThesisOverlap = 0.05;
// Of a detection's own area: see FrameMatch.
inline constexpr double kIgnoredShare = 0.5;

struct MotionScore {
  int truth = 0;       // boxes that count
  int detections = 0;  // without those that are ignored (FrameMatch)
  int hits = 0;

  // Nothing where there is nothing to divide by.
  std::optional<double> precision() const;
  std::optional<double> recall() const;
  std::optional<double> f1() const;
};

// Area of the intersection over area of the union.
double Overlap(const Box& a, const Box& b);

// What became of the boxes of one frame. Detections and truth are paired one to one, as many as can
// be where pairs must overlap by more than `least_overlap`; among equally many, pairs of large
// overlap are sought first. Truth of score 0 does not count. A detection is ignored where it has no
// partner, exceeds `least_overlap` with no truth that counts (else it is a duplicate, a false
// alarm), and at least kIgnoredShare of its own area lies on truth that does not count.
struct FrameMatch {
  static constexpr int kMiss = -1;      // no partner
  static constexpr int kIgnored = -2;   // does not count
  std::vector<int> truth_of_detection;  // index into the frame's truth
  std::vector<int> detection_of_truth;  // index into the frame's detections
};
FrameMatch MatchFrame(const std::vector<LabelledBox>& truth,
                      const std::vector<LabelledBox>& detections, double least_overlap);

// Boxes of all frames, in any order.
MotionScore ScoreMotion(const std::vector<LabelledBox>& truth,
                        const std::vector<LabelledBox>& detections,
                        double least_overlap = kThesisOverlap);

}  // namespace windhover::replay
