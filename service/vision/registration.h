// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/backend.h"
#include "service/options/options.h"
#include "service/vision/types.h"

namespace windhover {

// Registers the frames of a video one after the other (thesis 2.4): a global shift first, then
// tiled phase correlation under the predicted homography, RANSAC, DLT and covariance-weighted
// estimation. In anchor mode each frame is matched against a keyframe, in centre mode against its
// predecessor. No allocation after the first frames. One thread at a time.
class StreamRegistration {
 public:
  // Throws OptionError where there are too few tiles, or where the frame is smaller than they need
  // (the text says how small it may be).
  StreamRegistration(std::shared_ptr<Backend> backend, int width, int height,
                     const RegistrationOptions& options);
  ~StreamRegistration();

  // `frame` must have the size that was given. Never throws for what the picture shows: a frame
  // that cannot be registered comes back as kLost and starts a new segment.
  FrameRegistration Register(const GrayImage& frame);

  // Forgets all frames; the next one starts a new segment. Frame numbers count on.
  void Reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace windhover
