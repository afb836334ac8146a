// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "service/vision/types.h"

namespace windhover {

// The way that each track has come over the ground, in coordinates of the newest frame. Points are
// carried from frame to frame by the measured homographies, so that they stay where they lay on the
// ground while the camera moves.
class Trails {
 public:
  struct Trail {
    std::uint64_t track_id = 0;
    std::vector<Eigen::Vector2d> points;  // oldest first
    bool seen = false;                    // in the newest frame
    Box box;                              // where it was seen last
  };

  explicit Trails(int max_points) : max_points_(static_cast<std::size_t>(max_points)) {}

  // Where the ground is known anew or lost, all trails end. Trails of tracks that are not seen grow
  // shorter with every frame.
  void Advance(const FrameRegistration& registration, const std::vector<Detection>& detections);
  void Reset() { used_ = 0; }

  std::span<const Trail> trails() const { return {trails_.data(), used_}; }

 private:
  Trail& TrailOf(std::uint64_t track_id);

  std::size_t max_points_;
  // The first `used_` are in use; the others keep their memory for later ones.
  std::vector<Trail> trails_;
  std::size_t used_ = 0;
};

}  // namespace windhover
