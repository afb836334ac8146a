// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "replay/format/labels.h"
#include "replay/scoring/frame_match.h"

namespace windhover::replay {

struct MotionScore {
  int truth = 0;       // boxes that count
  int detections = 0;  // without those that are ignored (FrameMatch)
  int hits = 0;

  int false_alarms() const { return detections - hits; }
  // Nothing where there is nothing to divide by.
  std::optional<double> precision() const;
  std::optional<double> recall() const;
  std::optional<double> f1() const;

  MotionScore& operator+=(const MotionScore& other);
};

// The boxes of one frame.
struct FrameBoxes {
  int number = 0;  // from 1
  std::vector<LabelledBox> truth;
  std::vector<LabelledBox> detections;
};

// Boxes come in any order and stay in it within their frame. Frames without boxes are left out; the
// others come by number.
std::vector<FrameBoxes> BoxesByFrame(std::span<const LabelledBox> truth,
                                     std::span<const LabelledBox> detections);

// One for each frame. Everything else is counted from these.
std::vector<FrameMatch> MatchFrames(std::span<const FrameBoxes> frames, const HitRule& rule);

MotionScore CountHits(std::span<const FrameMatch> matches);

// Boxes of all frames, in any order.
MotionScore ScoreMotion(const std::vector<LabelledBox>& truth,
                        const std::vector<LabelledBox>& detections,
                        double least_overlap = kThesisOverlap);

}  // namespace windhover::replay
