// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "service/vision/motion_window.h"

namespace windhover {

// The forward-backward filter (thesis 6.5.2): a seed's intensity pattern is followed through the
// registered frames and back again, in both time directions; where it does not come back to where
// it started, it was no object that was followed.
//
// The pattern is a square of 9x9 cells around the seed, a cell being 1 to 4 px wide so that large
// things are followed as a whole. Only cells on seeds and next to them count, so that the resting
// ground around an object does not hold the pattern back. It is followed by the Lucas-Kanade method
// for pure translation with the pattern's mean taken out, first to the frame next to the centre,
// then to the third from it. The way back starts in that frame, with a pattern taken there.
class ForwardBackwardFilter {
 public:
  static constexpr int kMaxCellPx = 4;
  static constexpr int kSteps = 2;  // frames that a pattern is followed through in each direction

  struct Trace {
    // Where the pattern was found to move, px a frame on the grid, over the frames through which it
    // was followed; as expected where it was not.
    Eigen::Vector2f velocity_px = Eigen::Vector2f::Zero();
    // Distance in px between start and end; the larger one of the directions that are kept.
    float error_px = 0.0F;
    // Time directions, 0 to 2, that say anything.
    int directions = 0;
    // Whether a direction has an error within the margin, or none says anything.
    bool kept = false;
  };

  // `margin_px` is m of the thesis.
  explicit ForwardBackwardFilter(double margin_px);

  // Chooses the frames. The window must stay as it is until the next call.
  void SetWindow(std::span<const WindowSample> window, std::size_t centre);

  // Follows the pattern around `seed` (grid coordinates), which is expected to move by
  // `velocity_px` a frame, in cells of `cell_px`, 1 to kMaxCellPx. A direction without frames, or
  // in which the way leaves the ground that is seen, says nothing. One direction that agrees is
  // enough: the other may be hidden, or change its looks.
  Trace Follow(const Eigen::Vector2f& seed, const Eigen::Vector2f& velocity_px, int cell_px) const;

  // How well a pattern can be followed from a seed of the centre frame: the smaller eigenvalue of
  // its mean gradient tensor, (grey levels / cell)^2. 0 where ground is unseen.
  float Texture(const Eigen::Vector2f& seed, int cell_px) const;
  // Below this nothing can be followed.
  static constexpr float kMinTexture = 1.0F;

 private:
  struct Way {
    std::array<std::size_t, kSteps> samples;
    int count = 0;
  };
  struct Outcome {
    bool followed = false;   // false where it says nothing
    bool converged = false;  // false where the pattern was lost
    float error_px = 0.0F;
    Eigen::Vector2f end = Eigen::Vector2f::Zero();
    int end_offset_frames = 0;
  };

  Way ChooseWay(int direction) const;
  Outcome FollowWay(const Way& way, const Eigen::Vector2f& seed, const Eigen::Vector2f& velocity_px,
                    int cell_px) const;

  double margin_px_;
  std::span<const WindowSample> window_;
  std::size_t centre_ = 0;
  std::array<Way, 2> ways_;
};

}  // namespace windhover
