// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "replay/format/labels.h"

namespace windhover::replay {

// Thesis 6.6: a low overlap, because a pixel is much of a small object.
inline constexpr double kThesisOverlap = 0.05;

struct MotionScore {
  int truth = 0;       // boxes that count
  int detections = 0;  // without those that fell on truth that does not count
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
// overlap are sought first. Truth of score 0 does not count: what overlaps only it is left out.
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
