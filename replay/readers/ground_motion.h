// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "service/vision/types.h"

namespace windhover::replay {

// How the frames of a recording lie over the ground, from truth or measured. Homographies are known
// up to scale.
struct GroundMotion {
  std::vector<Eigen::Matrix3d> first_from_frame;
  // Frames of different segments cannot be compared: registration was lost between them.
  std::vector<int> segment;
};

GroundMotion TrueGroundMotion(const std::vector<Eigen::Matrix3d>& first_from_frame);
// Composed from previous_from_frame, a segment ending where the next starts.
GroundMotion MeasuredGroundMotion(std::span<const FrameRegistration> registrations);

// Of one figure over the pairs of neighbouring frames.
struct Spread {
  double least = 0;
  double median = 0;
  double largest = 0;
};

// How the camera moves from a frame to the next one, at the middle of the ground that is seen.
struct CameraStatistics {
  int pairs = 0;  // in one segment
  int lost = 0;   // that are not
  // Nothing where there is no pair.
  std::optional<Spread> shift_px;      // how far the ground moves in the picture
  std::optional<Spread> rotation_deg;  // about the optical axis, 0 to 180 without sign
  std::optional<Spread> scale;         // by how much things grow, 1 where they do not
  std::optional<Spread> overlap;       // share of the frame, 0 to 1, that the one before shows, too
};

// `horizons` (horizon.h) is empty or has an entry for each frame: then the middle is that of the
// ground alone.
CameraStatistics SummariseCamera(const GroundMotion& motion, int width, int height,
                                 std::span<const Eigen::Vector3d> horizons = {});

}  // namespace windhover::replay
