// SPDX-License-Identifier: Apache-2.0
#include "replay/app/score_text.h"

#include <spdlog/fmt/fmt.h>

#include <optional>

namespace windhover::replay {
namespace {

std::string Percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100 * *share) : "-";
}

std::string Pixels(const std::optional<double>& distance) {
  return distance ? fmt::format("{:.4f} px", *distance) : "-";
}

}  // namespace

std::string Describe(const MotionScore& score, double overlap) {
  return fmt::format(
      "motion at overlap {:.2f}: precision {}, recall {}, F1 {} ({} hits of {} detections, {} "
      "boxes "
      "in truth)",
      overlap, Percent(score.precision()), Percent(score.recall()), Percent(score.f1()), score.hits,
      score.detections, score.truth);
}

std::string Describe(const RegistrationScore& score) {
  std::string text = fmt::format(
      "registration over {} pairs: RMS mean {}, max {}, {} over {} px, drift {:.3f} px at the last "
      "frame",
      score.pairs, Pixels(score.mean_px), Pixels(score.max_px), score.failures, kFailurePx,
      score.drift_px);
  if (score.without_ground > 0) {
    text += fmt::format("; {} pairs show no common ground", score.without_ground);
  }
  return text;
}

}  // namespace windhover::replay
