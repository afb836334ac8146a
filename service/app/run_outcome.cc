// SPDX-License-Identifier: Apache-2.0
#include "service/app/run_outcome.h"

#include <spdlog/fmt/fmt.h>

#include <tuple>

namespace windhover {

std::string Loss(const RunOutcome& outcome) {
  const std::uint64_t frames = outcome.frames_out;
  if (outcome.failed_samples > 0) {
    return fmt::format("{} samples could not be written to the bus", outcome.failed_samples);
  }
  if (outcome.source_reach.frames != frames) {
    return fmt::format("{} frames went in, {} came out", outcome.source_reach.frames, frames);
  }
  const auto& [published, received] = std::tie(outcome.published, outcome.received);
  for (const auto& [name, sent, arrived] :
       {std::tuple("homographies", published.homographies, received.homographies),
        {"detections", published.detections, received.detections}}) {
    if (sent != frames || arrived != sent) {
      return fmt::format("{} frames, but {} samples of {} published and {} received", frames, sent,
                         name, arrived);
    }
  }
  if (published.boxes != received.boxes) {
    return fmt::format("{} boxes published, {} received", published.boxes, received.boxes);
  }
  return "";
}

std::string Summary(const RunOutcome& outcome) {
  return fmt::format(
      "{}: {} frames in, {} out; homographies {} published, {} received; detections {} published, "
      "{} received; {} boxes; {:.1f} frames/s; {}",
      outcome.source, outcome.source_reach.frames, outcome.frames_out,
      outcome.published.homographies, outcome.received.homographies, outcome.published.detections,
      outcome.received.detections, outcome.received.boxes, outcome.frames_per_second,
      outcome.device);
}

}  // namespace windhover
