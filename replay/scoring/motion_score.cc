// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/motion_score.h"

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

MotionScore& MotionScore::operator+=(const MotionScore& other) {
  truth += other.truth;
  detections += other.detections;
  hits += other.hits;
  return *this;
}

std::vector<FrameBoxes> BoxesByFrame(std::span<const LabelledBox> truth,
                                     std::span<const LabelledBox> detections) {
  std::map<int, FrameBoxes> by_number;
  for (const LabelledBox& box : truth) by_number[box.frame].truth.push_back(box);
  for (const LabelledBox& box : detections) by_number[box.frame].detections.push_back(box);
  std::vector<FrameBoxes> frames;
  frames.reserve(by_number.size());
  for (auto& [number, frame] : by_number) {
    frame.number = number;
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<FrameMatch> MatchFrames(std::span<const FrameBoxes> frames, const HitRule& rule) {
  std::vector<FrameMatch> matches;
  matches.reserve(frames.size());
  for (const FrameBoxes& frame : frames) {
    matches.push_back(MatchFrame(frame.truth, frame.detections, rule));
  }
  return matches;
}

MotionScore CountHits(std::span<const FrameMatch> matches) {
  MotionScore score;
  for (const FrameMatch& match : matches) {
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

MotionScore ScoreMotion(const std::vector<LabelledBox>& truth,
                        const std::vector<LabelledBox>& detections, double least_overlap) {
  const std::vector<FrameBoxes> frames = BoxesByFrame(truth, detections);
  return CountHits(MatchFrames(frames, HitRule::ByOverlap(least_overlap)));
}

}  // namespace windhover::replay
