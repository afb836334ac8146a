// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace windhover {

// Pictures: pixel centres at 0-based integers, x right, y down. `b_from_a` takes points of picture
// a to picture b.

enum class RegistrationQuality : std::uint8_t {
  kValid,     // use it
  kDegraded,  // found, but with few inliers or a large residual
  kLost,      // not found; the homographies are the identity and the covariance is zero
};

// What happened between a frame and the one before, beside the camera's usual motion.
enum class FrameChange : std::uint8_t {
  kSteady,
  kRepeated,   // the same picture again: a frozen source, or one that doubles frames
  kNoTexture,  // nothing to hold on to: black, fog, a covered lens
  kCut,        // other ground than before, or the same from too far away to be found again
  kJump,       // found, but over a tenth of the frame's width from where its motion led
};

constexpr const char* NameOf(FrameChange change) {
  constexpr const char* kNames[] = {"steady", "repeated", "no-texture", "cut", "jump"};
  return kNames[static_cast<int>(change)];
}

// How one frame of a stream lies over the ground: the outcome of registration.
struct FrameRegistration {
  // Counts the frames of a stream since its start, from 0.
  std::uint64_t frame_number = 0;
  // previous_from_frame: this frame's points to the frame before. Identity for the first frame and
  // where quality is kLost. Normalised to h33 = 1.
  Eigen::Matrix3d previous_from_frame = Eigen::Matrix3d::Identity();
  // Only in anchor mode: this frame's points to the anchor frame. h33 = 1.
  std::optional<Eigen::Matrix3d> anchor_from_frame;
  // Frame number of that anchor; this frame's own where it starts a segment. The anchor moves on
  // after a frame, not with it: each frame is measured against an anchor older than itself.
  std::uint64_t anchor_number = 0;
  // Covariance in px^2 of where the measured homography puts the frame's four corners, in the order
  // top left, top right, bottom right, bottom left, each x then y. The measured homography is
  // anchor_from_frame in anchor mode and previous_from_frame in centre mode.
  Eigen::Matrix<double, 8, 8> corner_covariance = Eigen::Matrix<double, 8, 8>::Zero();
  // Root mean square distance of the inliers from the homography, px.
  double residual_px = 0.0;
  int inliers = 0;
  int tiles = 0;
  // Share of the frame, 0 to 1, that lies on the picture it was registered to.
  double overlap = 1.0;
  RegistrationQuality quality = RegistrationQuality::kValid;
  // The first frame, and each frame from which on the ground is known anew (after a scene cut,
  // say): nothing before it can be compared with it.
  bool starts_segment = false;
  FrameChange change = FrameChange::kSteady;
};

// An upright box in frame coordinates, px: covers x <= px < x + width.
struct Box {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

// Something that moves over the ground, in one frame.
struct Detection {
  // Stable over the frames in which the same object is seen; counts from 1 in each stream.
  std::uint64_t track_id = 0;
  Box box;
  // Velocity over the ground, in px a frame along the axes of this frame.
  Eigen::Vector2d velocity_px = Eigen::Vector2d::Zero();
  // Confidence, 0 to 1.
  double score = 0.0;
  // Frames in which the track has been seen up to now.
  int age_frames = 0;
};

}  // namespace windhover
