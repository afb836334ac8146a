// SPDX-License-Identifier: Apache-2.0
#include "service/vision/tile_registration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "service/vision/tile_layout.h"

namespace windhover {
namespace {

// Up to here the minimal matches will do; nothing checks those, so that they make a degraded result
// at best.
constexpr int kFewTiles = 5;
// Below this share of the tiles, agreement is not told from chance.
constexpr double kMinInlierShareOfTiles = 0.2;

double LeastInliers(int tiles) {
  if (tiles <= kFewTiles) return kMinimalMatches;
  return std::max<double>(kMinimalMatches + 1, kMinInlierShareOfTiles * tiles);
}

TileWindow Window(WindowKind kind) {
  switch (kind) {
    case WindowKind::kNone:
      return TileWindow::kNone;
    case WindowKind::kBlackman:
      return TileWindow::kBlackman;
    case WindowKind::kCosine:
      return TileWindow::kCosine;
    case WindowKind::kGaussian:
      return TileWindow::kGaussian;
    case WindowKind::kTukey:
      return TileWindow::kTukey;
  }
  return TileWindow::kBlackman;
}

// Refuses an alpha that its window has no use for.
void CheckWindow(const RegistrationOptions& options) {
  const bool blackman = options.window == WindowKind::kBlackman;
  const bool gaussian = options.window == WindowKind::kGaussian;
  if ((blackman && options.window_alpha > 0.25) || (gaussian && options.window_alpha == 0.0)) {
    throw OptionError("option window-alpha = " + OptionText(options, "window-alpha") +
                      ": with window = " + OptionText(options, "window") + " it is " +
                      (blackman ? "0 to 0.25" : "over 0"));
  }
}

PhaseCorrelationSettings MakeSettings(int width, int height, const RegistrationOptions& options) {
  CheckWindow(options);
  TileLayout layout = UniformTileLayout(width, height, options.tile_columns, options.tile_rows,
                                        options.tile_layers);
  PhaseCorrelationSettings settings;
  settings.tile_width = layout.tile_width;
  settings.tile_height = layout.tile_height;
  settings.tiles = std::move(layout.tiles);
  settings.window = Window(options.window);
  settings.window_alpha = static_cast<float>(options.window_alpha);
  settings.peak_sigma_px = static_cast<float>(options.peak_sigma_px);
  settings.noise_sigma = static_cast<float>(options.noise_sigma);
  return settings;
}

Eigen::Vector2d Centre(const PhaseCorrelationSettings& settings, std::size_t tile) {
  return {settings.tiles[tile].x + 0.5 * (settings.tile_width - 1),
          settings.tiles[tile].y + 0.5 * (settings.tile_height - 1)};
}

// Tiles that agree perfectly still know their place only so well; the floor also keeps the
// covariance positive definite.
Eigen::Matrix2d Covariance(const TilePeak& peak) {
  constexpr double kFloorPx2 = 1e-4;
  Eigen::Matrix2d covariance;
  covariance << peak.covariance_xx + kFloorPx2, peak.covariance_xy, peak.covariance_xy,
      peak.covariance_yy + kFloorPx2;
  return covariance;
}

}  // namespace

TileRegistration::TileRegistration(Backend& backend, int width, int height,
                                   const RegistrationOptions& options)
    : width_(width),
      height_(height),
      options_(options),
      correlation_(backend.MakePhaseCorrelation(MakeSettings(width, height, options))),
      current_(correlation_->MakeSpectra()),
      estimator_(width, height, {.ransac_threshold_px = options.ransac_threshold_px}),
      peaks_(correlation_->settings().tiles.size()) {
  matches_.reserve(peaks_.size());
}

std::unique_ptr<TileSpectra> TileRegistration::MakeSpectra() const {
  return correlation_->MakeSpectra();
}

void TileRegistration::SetReference(const GrayImage& picture, TileSpectra& reference) {
  correlation_->Transform(picture, kIdentity3, reference);
}

bool TileRegistration::HasTexture(const TileSpectra& reference) {
  correlation_->Correlate(reference, reference, peaks_);
  const auto peaks =
      std::count_if(peaks_.begin(), peaks_.end(), [](const TilePeak& p) { return p.valid; });
  return static_cast<double>(peaks) >= LeastInliers(static_cast<int>(peaks_.size()));
}

TileMeasurement TileRegistration::Measure(const TileSpectra& reference, const GrayImage& frame,
                                          const Eigen::Matrix3d& predicted_frame_from_reference) {
  const TileMeasurement first = MeasureOnce(reference, frame, predicted_frame_from_reference);
  if (first.quality == RegistrationQuality::kLost ||
      !NeedsSecondPass(predicted_frame_from_reference, first.reference_from_frame)) {
    return first;
  }
  const TileMeasurement second =
      MeasureOnce(reference, frame, InverseHomography(first.reference_from_frame));
  return second.inliers >= first.inliers ? second : first;
}

TileMeasurement TileRegistration::MeasureOnce(
    const TileSpectra& reference, const GrayImage& frame,
    const Eigen::Matrix3d& predicted_frame_from_reference) {
  correlation_->Transform(frame, ToMatrix3(predicted_frame_from_reference), *current_);
  correlation_->Correlate(reference, *current_, peaks_);
  matches_.clear();
  for (std::size_t i = 0; i < peaks_.size(); ++i) {
    if (!peaks_[i].valid) continue;
    const Eigen::Vector2d centre = Centre(correlation_->settings(), i);
    const Eigen::Vector2d moved = centre + Eigen::Vector2d(peaks_[i].dx, peaks_[i].dy);
    matches_.push_back({.x_in_reference = centre,
                        .x_in_frame = Project(predicted_frame_from_reference, moved),
                        .covariance = Covariance(peaks_[i])});
  }

  TileMeasurement measurement;
  measurement.tiles = static_cast<int>(peaks_.size());
  const auto estimate = estimator_.Estimate(matches_);
  if (!estimate) return measurement;
  measurement.reference_from_frame = estimate->reference_from_frame;
  measurement.corner_covariance = estimate->corner_covariance;
  measurement.inliers = estimate->inliers;
  measurement.residual_px = estimate->residual_px;
  measurement.overlap =
      OverlapShare(estimate->reference_from_frame, width_, height_, width_, height_);
  measurement.quality = Judge(measurement, static_cast<int>(matches_.size()));
  if (measurement.quality == RegistrationQuality::kLost) {
    return {.inliers = measurement.inliers, .tiles = measurement.tiles};
  }
  return measurement;
}

// Tiles see the same ground, and their windows pull the shift little towards 0, while the
// prediction is right to a small fraction of their side; their peaks stay sharp while the ground in
// them moves by a fraction of a pixel against their centre.
bool TileRegistration::NeedsSecondPass(const Eigen::Matrix3d& predicted_frame_from_reference,
                                       const Eigen::Matrix3d& reference_from_frame) const {
  constexpr double kMaxShiftShare = 0.05;
  constexpr double kMaxSmearPx = 0.3;
  const auto& settings = correlation_->settings();
  const Eigen::Matrix3d residual = reference_from_frame * predicted_frame_from_reference;
  const Eigen::Vector2d half(0.5 * settings.tile_width, 0.5 * settings.tile_height);
  const double max_shift_px = kMaxShiftShare * std::min(settings.tile_width, settings.tile_height);
  for (const std::size_t i :
       {std::size_t{0}, settings.tiles.size() / 2, settings.tiles.size() - 1}) {
    const Eigen::Vector2d centre = Centre(settings, i);
    const Eigen::Vector2d shift = Project(residual, centre) - centre;
    const Eigen::Vector2d corner = centre + half;
    const Eigen::Vector2d corner_shift = Project(residual, corner) - corner;
    if (shift.cwiseAbs().maxCoeff() > max_shift_px || (corner_shift - shift).norm() > kMaxSmearPx) {
      return true;
    }
  }
  return false;
}

RegistrationQuality TileRegistration::Judge(const TileMeasurement& measurement, int peaks) const {
  if (measurement.inliers < LeastInliers(measurement.tiles)) return RegistrationQuality::kLost;
  const bool valid = measurement.inliers > kMinimalMatches &&
                     measurement.inliers >= options_.min_inlier_share * peaks &&
                     measurement.residual_px <= options_.max_residual_px;
  return valid ? RegistrationQuality::kValid : RegistrationQuality::kDegraded;
}

}  // namespace windhover
