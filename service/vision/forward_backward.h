// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "service/vision/motion_window.h"

namespace windhover {

// The forward-backward filter (thesis 6.5.2): a seed's intensity pattern is followed through the
// registered frames and back again, in both time directions; a seed whose pattern does not come
// back to where it started is no object.
//
// The pattern is a patch of 9x9 px, followed by the Lucas-Kanade method for pure translation with
// the patch's mean taken out, from one chosen frame to the next: 2, 4, ... frames from the centre.
// The way back starts from the last frame with a pattern taken there.
class ForwardBackwardFilter {
 public:
  struct Trace {
    // Where the pattern was found to move, px a frame on the grid, over all frames it was followed.
    Eigen::Vector2f velocity_px = Eigen::Vector2f::Zero();
    // Distance in px between start and end, the larger of both directions.
    float error_px = 0.0F;
    int directions = 0;  // time directions in which the pattern could be followed, 0 to 2
    bool kept = false;
  };

  // `margin_px` is m of the thesis.
  explicit ForwardBackwardFilter(double margin_px);

  // Chooses the frames. The window must stay as it is until the next call.
  void SetWindow(std::span<const WindowSample> window, std::size_t centre);

  // Follows the pattern around `seed` (grid coordinates), which is expected to move by
  // `velocity_px` a frame. A direction without frames, or in which the way leaves the ground that
  // is seen, says nothing; where both say nothing, the seed is kept.
  Trace Follow(const Eigen::Vector2f& seed, const Eigen::Vector2f& velocity_px) const;

 private:
  static constexpr int kSteps = 2;

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
  Outcome FollowWay(const Way& way, const Eigen::Vector2f& seed,
                    const Eigen::Vector2f& velocity_px) const;

  double margin_px_;
  std::span<const WindowSample> window_;
  std::size_t centre_ = 0;
  std::array<Way, 2> ways_;
};

}  // namespace windhover
