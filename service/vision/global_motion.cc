// SPDX-License-Identifier: Apache-2.0
#include "service/vision/global_motion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "service/vision/homography.h"

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

// One tile over the whole reduced picture, centred on it; it may be a little larger or smaller. Its
// window keeps more of the borders than the tiles' does: all that two pictures far apart share.
PhaseCorrelationSettings MakeSettings(int width, int height) {
  PhaseCorrelationSettings settings;
  settings.tile_width = TransformSide(width);
  settings.tile_height = TransformSide(height);
  settings.tiles = {{(width - settings.tile_width) / 2, (height - settings.tile_height) / 2}};
  settings.window = TileWindow::kCosine;
  return settings;
}

}  // namespace

GlobalMotion::GlobalMotion(Backend& backend, int width, int height)
    : factor_(ReductionFactor(width, height)),
      decimate_(backend.MakeDecimate()),
      reduced_(backend.MakeImage<std::uint8_t>(width / factor_, height / factor_)),
      previous_reduced_(backend.MakeImage<std::uint8_t>(reduced_.width(), reduced_.height())),
      correlation_(backend.MakePhaseCorrelation(MakeSettings(reduced_.width(), reduced_.height()))),
      previous_(correlation_->MakeSpectra()),
      current_(correlation_->MakeSpectra()),
      trial_(correlation_->MakeSpectra()) {
  const double f = factor_;
  full_from_reduced_ << f, 0, 0.5 * (f - 1), 0, f, 0.5 * (f - 1), 0, 0, 1;
  reduced_from_full_ = full_from_reduced_.inverse();
}

std::optional<Eigen::Vector2d> GlobalMotion::NextShift(const GrayImage& frame) {
  std::swap(previous_reduced_, reduced_);
  decimate_->Run(frame, factor_, reduced_);
  std::swap(previous_, current_);
  correlation_->Transform(reduced_, kIdentity3, *current_);
  has_two_ = std::exchange(has_previous_, true);
  if (!has_two_) return std::nullopt;
  TilePeak peak;
  correlation_->Correlate(*previous_, *current_, {&peak, 1});
  if (!peak.valid) return std::nullopt;
  return Eigen::Vector2d(factor_ * peak.dx, factor_ * peak.dy);
}

// Takes points of the previous reduced frame to this one, but for the shift.
Eigen::Matrix3d GlobalMotion::ReducedTurn(double radians, double zoom) const {
  const Eigen::Vector2d centre(0.5 * (reduced_.width() - 1), 0.5 * (reduced_.height() - 1));
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = zoom * Eigen::Rotation2Dd(radians).toRotationMatrix();
  turn.topRightCorner<2, 1>() = centre - turn.topLeftCorner<2, 2>() * centre;
  return turn;
}

TilePeak GlobalMotion::CorrelateUnder(const Eigen::Matrix3d& frame_from_previous) {
  correlation_->Transform(reduced_, ToMatrix3(frame_from_previous), *trial_);
  TilePeak peak;
  correlation_->Correlate(*previous_, *trial_, {&peak, 1});
  return peak;
}

GlobalMotion::Candidate GlobalMotion::Try(double radians, double zoom) {
  const Eigen::Matrix3d turn = ReducedTurn(radians, zoom);
  const TilePeak peak = CorrelateUnder(turn);
  // Sampled under the turn, what was at x in the previous frame is at x + (dx, dy).
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift.topRightCorner<2, 1>() << peak.dx, peak.dy;
  return {.frame_from_previous = full_from_reduced_ * turn * shift * reduced_from_full_,
          .clearness = peak.noise > 0.0F ? peak.height / peak.noise : 0.0F};
}

bool GlobalMotion::Repeats() const {
  if (!has_two_) return false;
  const auto now = reduced_.Read();
  const auto before = previous_reduced_.Read();
  for (int y = 0; y < now.height(); ++y) {
    if (!std::equal(now.row(y), now.row(y) + now.width(), before.row(y))) return false;
  }
  return true;
}

bool GlobalMotion::Confirms(const Eigen::Matrix3d& frame_from_previous) {
  constexpr double kFurthest = 0.5;  // px of the reduced picture
  const TilePeak peak =
      CorrelateUnder(reduced_from_full_ * frame_from_previous * full_from_reduced_);
  return peak.valid && std::hypot(peak.dx, peak.dy) <= kFurthest;
}

std::span<const Eigen::Matrix3d> GlobalMotion::SearchTurnsAndZooms() {
  constexpr int kTurns = 6;  // to either side
  constexpr double kTurnStep = 2.0 * std::numbers::pi / 180.0;
  constexpr int kZooms = 2;
  constexpr double kZoomStep = 1.06;
  candidates_.clear();
  for (int turn = -kTurns; turn <= kTurns; ++turn) {
    for (int zoom = -kZooms; zoom <= kZooms; ++zoom) {
      candidates_.push_back(Try(turn * kTurnStep, std::pow(kZoomStep, zoom)));
    }
  }
  const auto end_of_best = candidates_.begin() + static_cast<std::ptrdiff_t>(found_.size());
  std::partial_sort(
      candidates_.begin(), end_of_best, candidates_.end(),
      [](const Candidate& a, const Candidate& b) { return a.clearness > b.clearness; });
  std::transform(candidates_.begin(), end_of_best, found_.begin(),
                 [](const Candidate& candidate) { return candidate.frame_from_previous; });
  return found_;
}

}  // namespace windhover
