// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "replay/format/frame_source.h"
#include "replay/scoring/ground_residual.h"
#include "replay/scoring/summary.h"

namespace windhover::replay {

// Registers the second picture to the first, CV_8UC1: first_from_second, any scale; nothing where
// it finds none.
using PairRegister = std::function<std::optional<Eigen::Matrix3d>(const cv::Mat&, const cv::Mat&)>;

struct VideoScoreOptions {
  // Frames from the start to the end of a cycle, at least 1.
  int gap = 10;
  // Frames from the start of one cycle to that of the next.
  int every = 10;
  // Whether the source may go on after the frames that there are homographies of.
  bool from_start = false;
};

// Residuals over pairs of frames.
struct ResidualSummary {
  Summary warped;
  Summary unwarped;
  Summary noise;
  Summary misplacement_px;
  int without_common = 0;  // pairs of which too little is in common
};
ResidualSummary SummaryOf(const std::vector<std::optional<GroundResidual>>& residuals);

// How good homographies of a real video are, without truth.
struct VideoScore {
  int gap = 0;
  // Of frames 2, 3, ... against the one before: what registration leaves on the ground.
  std::vector<std::optional<GroundResidual>> consecutive;
  // The same between start and end of each cycle.
  std::vector<std::optional<GroundResidual>> across_gap;
  // RMS distance in px, over the ground that both ends of a cycle show, between the homographies
  // composed from frame to frame (a -> b -> ... -> c) and the one found for both ends at once
  // (a -> c). Nothing where the ends show no ground in common or none was found for them; the
  // latter are counted.
  std::vector<std::optional<double>> cycles_px;
  int unregistered = 0;
};

// `first_from_frame` has an entry for each frame of `source`; throws FormatError where the source
// has fewer, or more although `from_start` is not set, with `name` for the source, and what the
// source throws. `on_frame` is called after each frame.
VideoScore ScoreVideo(FrameSource& source, const std::string& name,
                      const std::vector<Eigen::Matrix3d>& first_from_frame,
                      const VideoScoreOptions& options, const PairRegister& register_pair,
                      const std::function<void()>& on_frame);

}  // namespace windhover::replay
