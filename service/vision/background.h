// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/backend.h"
#include "service/options/options.h"
#include "service/vision/motion_evidence.h"
#include "service/vision/types.h"

namespace windhover {

// The sliding window of registered frames, its median background and the motion seeds (thesis 6.3).
// Frames that carry an anchor_from_frame are composed through it; others are registered to the
// window's centre frame here. A window never reaches over the start of a segment. No allocation per
// frame once the window is full, as long as evidence is let go in time. One thread at a time.
class BackgroundSubtraction {
 public:
  // `registration` is used in centre mode only, from the first Pop on. Throws OptionError where an
  // option is out of its range.
  BackgroundSubtraction(std::shared_ptr<Backend> backend, int width, int height,
                        const BackgroundOptions& options, const RegistrationOptions& registration);
  ~BackgroundSubtraction();

  // Takes the next frame (copied) and how it is registered.
  void Push(const GrayImage& frame, const FrameRegistration& registration);
  // No frame follows in this window: what is held comes out without its future frames.
  void Drain();
  // Evidence for the oldest frame that has not come out yet, once its window is complete; null
  // until then. Each pushed frame comes out exactly once, in order. Call until null after Push and
  // Drain. In centre mode throws OptionError as StreamRegistration's constructor does.
  std::shared_ptr<const MotionEvidence> Pop();
  // Forgets everything that is held.
  void Reset();

  // Frames of delay between a frame's Push and its evidence.
  int lookahead() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace windhover
