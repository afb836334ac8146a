// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/options/option.h"

namespace windhover {

struct DeviceOptions {
  std::string device;

  static constexpr auto Fields() {
    return std::make_tuple(
        Text("device", &DeviceOptions::device,
             "Compute device: cpu, or <platform>:<CPU|GPU>:<name|id> with parts that may be empty; "
             "empty takes WINDHOVER_DEVICE, else the best OpenCL device, else the CPU"));
  }
};

// What the frames of a window are registered to.
enum class ReferenceMode {
  kCentre,  // the window's centre frame (thesis 6.3): 2k registrations a frame
  kAnchor,  // a keyframe that moves on when overlap shrinks: one registration a frame
};

// What fades each tile out towards its border (thesis 2.4.4).
enum class WindowKind { kNone, kBlackman, kCosine, kGaussian, kTukey };

// Tiled phase correlation and the homography from its matches (thesis 2.4).
struct RegistrationOptions {
  ReferenceMode reference = ReferenceMode::kAnchor;
  int tile_columns = 6;
  int tile_rows = 6;
  int tile_layers = 1;
  WindowKind window = WindowKind::kBlackman;
  double window_alpha = 0.16;
  double peak_sigma_px = 1.0;
  double noise_sigma = 4.0;
  double ransac_threshold_px = 1.0;
  double min_inlier_share = 0.4;
  double max_residual_px = 1.0;
  double max_error_px = 1.0;
  double refine_above_px = 0.2;
  double min_overlap = 0.8;
  double min_agreement = 0.8;

  static constexpr auto Fields() {
    using O = RegistrationOptions;
    return std::make_tuple(
        Choice("reference", &O::reference, std::array<std::string_view, 2>{"centre", "anchor"},
               std::array<std::string_view, 2>{
                   "every frame of the window is registered to its centre frame, as in the thesis",
                   "every frame is registered once, to a keyframe that moves on"},
               "What the frames of a window are registered to"),
        Number("tile-columns", &O::tile_columns, 2, 25, "", "Tiles across the picture"),
        Number("tile-rows", &O::tile_rows, 2, 25, "", "Tiles down the picture"),
        Number("tile-layers", &O::tile_layers, 1, 2, "",
               "2 lays another tile between each four neighbours"),
        Choice("window", &O::window,
               std::array<std::string_view, 5>{"none", "blackman", "cosine", "gaussian", "tukey"},
               std::array<std::string_view, 5>{
                   "tiles as they are", "the exact Blackman window, window-alpha 0 to 0.25",
                   "half a period of a cosine",
                   "a Gaussian, window-alpha its standard deviation as a share of the side",
                   "flat over window-alpha of the side, between two tapers"},
               "What fades each tile out towards its border"),
        Number("window-alpha", &O::window_alpha, 0.0, 1.0, "", "The window's parameter"),
        Number("peak-sigma", &O::peak_sigma_px, 0.0, 4.0, "px",
               "Standard deviation that the correlation peak is smoothed to; 0 smooths nothing"),
        Number("noise-sigma", &O::noise_sigma, 0.1, 64.0, "grey levels",
               "Standard deviation of the sensor's noise; weaker frequencies are damped"),
        Number("ransac-threshold", &O::ransac_threshold_px, 0.1, 20.0, "px",
               "Largest distance from the homography at which a tile's match is an inlier"),
        Number("min-inlier-share", &O::min_inlier_share, 0.1, 1.0, "",
               "Share of the tiles with a correlation peak that must agree for a homography to be "
               "valid"),
        Number("max-residual", &O::max_residual_px, 0.05, 20.0, "px",
               "RMS distance of the inliers from the homography above which it is degraded"),
        Number("max-error", &O::max_error_px, 0.05, 100.0, "px",
               "Expected RMS error of the frame's corners above which the homography is degraded"),
        Number("refine-above", &O::refine_above_px, 0.0, 100.0, "px",
               "Expected RMS error of the frame's corners above which finer tiles are matched as "
               "well; 0 does so for every frame"),
        Number("min-overlap", &O::min_overlap, 0.3, 0.99, "",
               "Share of the frame that must lie on the anchor; below it the anchor moves on"),
        Number("min-agreement", &O::min_agreement, 0.0, 1.0, "",
               "Inliers, as a share of the most that this anchor has had, below which it moves on: "
               "what stands out of the ground agrees less and less as the camera flies past"));
  }
};

// The sliding window and its median background (thesis 6.3).
struct BackgroundOptions {
  int k = 10;
  int lookahead = 10;
  int threshold = 20;
  double gradient_gain_px = 0.0;

  static constexpr auto Fields() {
    using O = BackgroundOptions;
    return std::make_tuple(
        Number("k", &O::k, 1, 40, "frames", "Past frames in the window around each frame"),
        Number("lookahead", &O::lookahead, 0, 40, "frames",
               "Future frames in the window; that many frames of delay. More than k counts as k"),
        Number("threshold", &O::threshold, 1, 255, "grey levels",
               "Difference from the background that makes a pixel a motion seed"),
        Number("gradient-gain", &O::gradient_gain_px, 0.0, 4.0, "px",
               "Registration error forgiven where the background has edges: the threshold grows "
               "by this times the background's gradient"));
  }
};

// Voting, forward-backward filter, extraction and tracks (thesis 6.5, 6.3).
struct MotionOptions {
  double max_speed_px = 10.0;
  double min_speed_px = 0.6;
  double vote_share = 0.5;
  double forward_backward_margin_px = 2.0;
  int erosion_px = 0;
  int dilation_px = -1;
  int min_area_px = 12;
  double max_size = 0.33;
  double min_travel_px = 3.0;
  int min_track_frames = 3;
  int max_coast_frames = 5;

  static constexpr auto Fields() {
    using O = MotionOptions;
    return std::make_tuple(
        Number("max-speed", &O::max_speed_px, 0.1, 50.0, "px/frame",
               "Fastest object looked for, relative to the ground"),
        Number("min-speed", &O::min_speed_px, 0.0, 50.0, "px/frame",
               "Slowest object looked for, relative to the ground; things that stand out of the "
               "ground seem to move slowly as the camera does"),
        Number("vote-share", &O::vote_share, 0.0, 1.0, "",
               "Share of the window's frames that must vote for one trajectory through a seed; 0 "
               "switches the voting filter off"),
        Number("forward-backward-margin", &O::forward_backward_margin_px, 0.0, 20.0, "px",
               "Distance from its start at which a point tracked forward and back may end; 0 "
               "switches the forward-backward filter off"),
        Number("erosion", &O::erosion_px, 0, 10, "px", "Radius of the erosion of the seeds left"),
        Number("dilation", &O::dilation_px, -1, 20, "px",
               "Radius of the dilation that closes the gaps inside an object; -1 takes 1 px for "
               "each 400 rows of the picture, at least 1"),
        Number("min-area", &O::min_area_px, 1, 100000, "px^2",
               "Smallest area of seeds that makes a detection"),
        Number("max-size", &O::max_size, 0.01, 1.0, "",
               "Longest side of a detection's box, as a share of the frame's shorter side"),
        Number(
            "min-travel", &O::min_travel_px, 0.0, 1000.0, "px",
            "Way over the ground that a track must have made before it is reported, and a quarter "
            "of its box's shorter side at least; 0 asks for none"),
        Number("min-track-frames", &O::min_track_frames, 1, 100, "frames",
               "Detections that a track must have had before it is reported"),
        Number("max-coast-frames", &O::max_coast_frames, 0, 100, "frames",
               "Frames that a track survives without a detection"));
  }
};

}  // namespace windhover
