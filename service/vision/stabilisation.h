// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "service/options/stabilisation_options.h"
#include "service/vision/camera_path.h"
#include "service/vision/screen_pose.h"
#include "service/vision/types.h"

namespace windhover {

// Where a frame is shown on a screen of its own size, and how that screen lies on others. Poses are
// homographies screen_from_frame, px, normalised to h33 = 1.
struct ScreenPose {
  Eigen::Matrix3d screen_from_frame = Eigen::Matrix3d::Identity();
  // Where a point of the ground on this screen was on the screen before. Where the ground is known
  // anew, what is shown is taken to lie where the frame before lay.
  Eigen::Matrix3d previous_screen_from_screen = Eigen::Matrix3d::Identity();
  // False for the first frame, and where the ground is known anew.
  bool continues = false;
  // Pose of the frame that this one was measured against: of its anchor or, without one, of the
  // frame before.
  Eigen::Matrix3d reference_screen_from_reference = Eigen::Matrix3d::Identity();
  // Number under which that anchor was shown: its own, or that of the first frame after a start
  // between it and here.
  std::uint64_t anchor_number = 0;
};

// Decides where the frames of a shaking camera are shown so that the picture holds still. In anchor
// mode the ground keeps its place on the screen; where more than max_off_screen of the frame would
// lie off it, the picture glides to where the camera will be when it arrives. In smooth mode the
// picture follows the camera's way: a local linear regression, with Gaussian weights in time, of
// where the frame's corners lie, which does not lag behind a steady camera even without future
// frames.
//
// Where the ground is lost, the last pose is held; once it is known again, the picture glides to
// its new place. Every pose stays within PoseLimits. One thread at a time; no allocation after
// construction.
class Stabilisation {
 public:
  // Width and height of the frames, px, at least 2. Throws OptionError where an option is out of
  // its range.
  Stabilisation(int width, int height, const StabilisationOptions& options, double frame_rate_hz);

  // Takes how the next frame lies over the ground. Pop until nothing comes after each.
  void Push(const FrameRegistration& registration);
  // No frame follows: those that are held come out without future ones.
  void Drain() { draining_ = true; }
  // The pose of the oldest frame that has not come out yet, once lookahead() later ones have come.
  std::optional<ScreenPose> Pop();
  // The next frame has nothing to do with those before.
  void Reset();

  // Frames of delay between a frame's Push and its pose.
  int lookahead() const { return lookahead_; }

 private:
  Eigen::Matrix3d FollowGround();
  Eigen::Matrix3d SmoothedPose() const;
  Eigen::Matrix3d PredictedPose() const;
  void StartGlide(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to);
  Eigen::Matrix3d Glide(const Eigen::Matrix3d& pose);
  ScreenPose Describe(const Eigen::Matrix3d& screen_from_frame);

  int width_;
  int height_;
  StabilisationMode mode_;
  int smoothing_frames_;
  int lookahead_;
  PoseLimits comfort_;  // beyond it anchor mode centres anew
  PoseLimits bounds_;   // of every pose that is shown
  CameraPath path_;
  bool draining_ = false;

  // All but `shown_` are poses before the crop.
  Eigen::Matrix3d held_ = Eigen::Matrix3d::Identity();  // in anchor mode, where no glide is on
  // A glide: what is left of the old place, as shown_from_aimed, and the frames that it has taken.
  Eigen::Matrix3d glide_start_ = Eigen::Matrix3d::Identity();
  int glide_frames_;

  // Of the newest frame that came out.
  bool has_shown_ = false;
  std::uint64_t shown_number_ = 0;
  Eigen::Matrix3d shown_ = Eigen::Matrix3d::Identity();
  // The newest anchor: the number it was shown under, and its pose there.
  std::uint64_t anchor_shown_number_ = 0;
  Eigen::Matrix3d anchor_screen_from_anchor_ = Eigen::Matrix3d::Identity();
};

}  // namespace windhover
