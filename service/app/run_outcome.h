// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

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
  std::uint64_t frames_in = 0;
  std::uint64_t frames_out = 0;
  Samples published;
  Samples received;
  std::uint64_t failed_samples = 0;  // could not be written to the bus
  double frames_per_second = 0.0;
  std::string device;
  // Time of the source up to which frames came in, its length (0 where it is not known), and the
  // bytes that are known to be missing at its end.
  std::int64_t reached_ns = 0;
  std::int64_t length_ns = 0;
  std::int64_t missing_bytes = 0;
};

// What was lost on the way, in one line; empty where every frame and every sample has arrived.
std::string Loss(const RunOutcome& outcome);
// How far the source goes, where it ends half a second or more before its length; else empty.
std::string CutOff(const RunOutcome& outcome);
// The summary line.
std::string Summary(const RunOutcome& outcome);

}  // namespace windhover
