// SPDX-License-Identifier: Apache-2.0
#include "replay/app/score_text.h"

#include <spdlog/fmt/fmt.h>

#include <optional>

namespace windhover::replay {
namespace {

std::string Percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100 * *share) : "-";
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
  return fmt::format(
      "registration over {} pairs: RMS mean {:.4f} px, max {:.4f} px, {} over {} px, drift {:.3f} "
      "px at the last frame",
      score.rms_px.size(), score.mean_px, score.max_px, score.failures, kFailurePx, score.drift_px);
}

}  // namespace windhover::replay
