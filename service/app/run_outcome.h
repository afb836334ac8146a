// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "service/gstreamer/source_reach.h"

namespace windhover {

// What a run has come to.
struct RunOutcome {
  // Samples of each topic, and the detections in them.
  struct Samples {
    std::uint64_t homographies = 0;
    std::uint64_t detections = 0;
    std::uint64_t boxes = 0;
  };

  std::string source;
  SourceReach source_reach;
  std::uint64_t frames_out = 0;
  Samples published;
  Samples received;
  std::uint64_t failed_samples = 0;  // could not be written to the bus
  double frames_per_second = 0.0;
  std::string device;
};

// What was lost on the way, in one line; empty where every frame and every sample has arrived.
std::string Loss(const RunOutcome& outcome);
// The summary line.
std::string Summary(const RunOutcome& outcome);

}  // namespace windhover
