// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "replay/scoring/motion_score.h"

namespace windhover::replay {

// Bounds between classes of size, px: the square root of a box's area. As in AI-TOD (Wang et al.,
// "Tiny Object Detection in Aerial Images", ICPR 2020), which calls them very tiny, tiny, small and
// medium.
inline constexpr std::array<double, 3> kSizeBoundsPx = {8, 16, 32};
// Bounds between classes of speed over the ground, px a frame. Below the first lies what creeps,
// below the second a walker in a near hover (sequence 6).
inline constexpr std::array<double, 4> kSpeedBoundsPx = {0.5, 1.5, 3, 6};
// Frames to both sides over which a speed is taken.
inline constexpr int kSpeedFrames = 5;

// Found among the objects of one class. There is no precision by class: what a false alarm would
// have been, nobody knows.
struct ClassRecall {
  double least = 0;             // of the class, px or px a frame
  std::optional<double> below;  // nothing: the class is open above
  int truth = 0;
  int hits = 0;

  std::optional<double> recall() const;
};

// Adds up two of the same bounds.
void AddClasses(std::vector<ClassRecall>& sum, std::span<const ClassRecall> other);

// `matches` are of `frames`, as MatchFrames has them.
std::vector<ClassRecall> RecallBySize(std::span<const FrameBoxes> frames,
                                      std::span<const FrameMatch> matches);

// Speeds of the truth's boxes over the ground in px a frame of their own frame, in the order of
// the frames and their boxes: how far the middle of the box travels between the first and the last
// frame, within kSpeedFrames around, in which the object is labelled, camera motion taken out.
// `first_from_frame` (entry i is of frame i + 1) is known up to scale; where it is empty the camera
// is taken to stand. Nothing for a box that has no identity or no other frame near by. Throws
// std::invalid_argument where there are fewer homographies than frames.
std::vector<std::vector<std::optional<double>>> GroundSpeeds(
    std::span<const FrameBoxes> frames, std::span<const Eigen::Matrix3d> first_from_frame);

// Boxes without speed are in no class.
std::vector<ClassRecall> RecallBySpeed(std::span<const FrameBoxes> frames,
                                       std::span<const FrameMatch> matches,
                                       std::span<const Eigen::Matrix3d> first_from_frame);

}  // namespace windhover::replay
