// SPDX-License-Identifier: Apache-2.0
#include "service/vision/global_shift.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace windhover {
namespace {

constexpr int kReducedSidePx = 192;
constexpr int kMaxFactor = 16;
constexpr int kMinTransform = 16;
constexpr int kMaxTransform = 512;

int ReductionFactor(int width, int height) {
  const int larger = std::max(width, height);
  return std::clamp((larger + kReducedSidePx - 1) / kReducedSidePx, 1, kMaxFactor);
}

int TransformSide(int side_px) {
  return std::clamp(1 << std::lround(std::log2(side_px)), kMinTransform, kMaxTransform);
}

// One tile over the whole reduced picture, centred on it; it may be a little larger or smaller.
PhaseCorrelationSettings MakeSettings(int width, int height) {
  PhaseCorrelationSettings settings;
  settings.tile_width = TransformSide(width);
  settings.tile_height = TransformSide(height);
  settings.tiles = {{(width - settings.tile_width) / 2, (height - settings.tile_height) / 2}};
  return settings;
}

}  // namespace

GlobalShift::GlobalShift(Backend& backend, int width, int height)
    : factor_(ReductionFactor(width, height)),
      decimate_(backend.MakeDecimate()),
      reduced_(backend.MakeImage<std::uint8_t>(width / factor_, height / factor_)),
      correlation_(backend.MakePhaseCorrelation(MakeSettings(reduced_.width(), reduced_.height()))),
      previous_(correlation_->MakeSpectra()),
      current_(correlation_->MakeSpectra()) {}

std::optional<Eigen::Vector2d> GlobalShift::Next(const GrayImage& frame) {
  decimate_->Run(frame, factor_, reduced_);
  std::swap(previous_, current_);
  correlation_->Transform(reduced_, kIdentity3, *current_);
  if (!std::exchange(has_previous_, true)) return std::nullopt;
  TilePeak peak;
  correlation_->Correlate(*previous_, *current_, {&peak, 1});
  if (!peak.valid) return std::nullopt;
  return Eigen::Vector2d(factor_ * peak.dx, factor_ * peak.dy);
}

}  // namespace windhover
