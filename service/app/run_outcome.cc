// SPDX-License-Identifier: Apache-2.0
#include "service/app/run_outcome.h"

#include <spdlog/fmt/fmt.h>

#include <tuple>

namespace windhover {
namespace {

constexpr std::int64_t kCutOffNs = 500'000'000;

}  // namespace

std::string Loss(const RunOutcome& outcome) {
  const std::uint64_t frames = outcome.frames_out;
  if (outcome.failed_samples > 0) {
    return fmt::format("{} samples could not be written to the bus", outcome.failed_samples);
  }
  if (outcome.frames_in != frames) {
    return fmt::format("{} frames went in, {} came out", outcome.frames_in, frames);
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

std::string CutOff(const RunOutcome& outcome) {
  if (outcome.missing_bytes > 0) {
    return fmt::format("is cut off: {} bytes are missing; it ends after {:.2f} s, {} frames",
                       outcome.missing_bytes, 1e-9 * outcome.reached_ns, outcome.frames_in);
  }
  if (outcome.length_ns - outcome.reached_ns < kCutOffNs) return "";
  return fmt::format("is cut off: it ends after {:.2f} s of {:.2f} s, {} frames",
                     1e-9 * outcome.reached_ns, 1e-9 * outcome.length_ns, outcome.frames_in);
}

std::string Summary(const RunOutcome& outcome) {
  return fmt::format(
      "{}: {} frames in, {} out; homographies {} published, {} received; detections {} published, "
      "{} received; {} boxes; {:.1f} frames/s; {}",
      outcome.source, outcome.frames_in, outcome.frames_out, outcome.published.homographies,
      outcome.received.homographies, outcome.published.detections, outcome.received.detections,
      outcome.received.boxes, outcome.frames_per_second, outcome.device);
}

}  // namespace windhover
