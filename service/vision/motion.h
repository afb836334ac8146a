// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "service/options/options.h"
#include "service/vision/motion_evidence.h"
#include "service/vision/types.h"

namespace windhover {

// From motion seeds to tracked detections: voting filter (thesis 6.5.1), forward-backward filter
// (6.5.2), morphology, connected components and boxes (6.3), tracks. One thread at a time.
class MotionDetection {
 public:
  explicit MotionDetection(const MotionOptions& options);
  ~MotionDetection();

  // Detections in the evidence's centre frame, in its coordinates. Frames must come in order.
  const std::vector<Detection>& Detect(const MotionEvidence& evidence);
  // Forgets all tracks; ids are not used again.
  void Reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace windhover
