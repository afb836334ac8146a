// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "service/vision/types.h"

namespace windhover {

// The way of a camera over the ground around a current frame: how each frame lies on the one before
// it, for a number of past frames and for those that have come since. No allocation after
// construction.
class CameraPath {
 public:
  struct Step {
    std::uint64_t frame_number = 0;
    std::uint64_t anchor_number = 0;
    std::optional<Eigen::Matrix3d> anchor_from_frame;
    // To the frame pushed before; nothing where the ground is known anew from here on.
    std::optional<Eigen::Matrix3d> previous_from_frame;
  };

  // `past` frames are kept behind the current one; at most `future` + 1 are pushed ahead of it.
  CameraPath(int past, int future);

  // The next frame. Where frames between it and the one before are missing, both are compared
  // through the anchor, as far as that is known.
  void Push(const FrameRegistration& registration);
  // Frames pushed that are still ahead of the current one.
  int ahead() const { return static_cast<int>(pushed_ - next_); }
  // Makes the next frame the current one; there must be one ahead.
  void Advance() { ++next_; }
  void Reset();

  const Step& current() const { return At(next_ - 1); }

  // Calls visit(frames, current_from_other) for the frames before the current one (frames = -1, -2,
  // ...) or behind it (1, 2, ...), until it returns false, the ground is known anew or none is
  // left.
  template <typename Visit>
  void VisitPast(Visit visit) const {
    Eigen::Matrix3d current_from_other = Eigen::Matrix3d::Identity();
    for (int i = 1; i <= past_ && static_cast<std::uint64_t>(i) < next_; ++i) {
      const Step& step = At(next_ - static_cast<std::uint64_t>(i));
      if (!step.previous_from_frame) return;
      current_from_other = current_from_other * step.previous_from_frame->inverse();
      current_from_other /= current_from_other(2, 2);
      if (!visit(-i, current_from_other)) return;
    }
  }
  template <typename Visit>
  void VisitFuture(Visit visit) const {
    Eigen::Matrix3d current_from_other = Eigen::Matrix3d::Identity();
    for (int i = 1; i <= ahead(); ++i) {
      const Step& step = At(next_ - 1 + static_cast<std::uint64_t>(i));
      if (!step.previous_from_frame) return;
      current_from_other = current_from_other * *step.previous_from_frame;
      current_from_other /= current_from_other(2, 2);
      if (!visit(i, current_from_other)) return;
    }
  }

 private:
  const Step& At(std::uint64_t index) const { return steps_[index % steps_.size()]; }

  int past_;
  std::vector<Step> steps_;   // a ring
  std::uint64_t pushed_ = 0;  // frames since the start
  std::uint64_t next_ = 0;    // index of the frame after the current one
};

}  // namespace windhover
