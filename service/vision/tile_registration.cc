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

double LeastInliers(double tiles) {
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
  constexpr double kFloorPx2 = 1e-3;
  Eigen::Matrix2d covariance;
  covariance << peak.covariance_xx + kFloorPx2, peak.covariance_xy, peak.covariance_xy,
      peak.covariance_yy + kFloorPx2;
  return covariance;
}

// Null where the pictures are too small for finer tiles.
std::unique_ptr<PhaseCorrelation> MakeFineCorrelation(Backend& backend, int width, int height,
                                                      const RegistrationOptions& options) {
  const auto finer = [](int count) { return std::min((5 * count + 2) / 3, 25); };
  RegistrationOptions fine = options;
  fine.tile_columns = finer(options.tile_columns);
  fine.tile_rows = finer(options.tile_rows);
  fine.tile_layers = 1;
  if (!FitsTileLayout(width, height, fine.tile_columns, fine.tile_rows)) return nullptr;
  return backend.MakePhaseCorrelation(MakeSettings(width, height, fine));
}

}  // namespace

TileRegistration::Layout::Layout(std::unique_ptr<PhaseCorrelation> correlation_in)
    : correlation(std::move(correlation_in)),
      current(correlation->MakeSpectra()),
      peaks(correlation->settings().tiles.size()) {}

TileRegistration::TileRegistration(Backend& backend, int width, int height,
                                   const RegistrationOptions& options)
    : width_(width),
      height_(height),
      options_(options),
      coarse_(backend.MakePhaseCorrelation(MakeSettings(width, height, options))),
      estimator_(width, height, {.ransac_threshold_px = options.ransac_threshold_px}) {
  if (auto fine = MakeFineCorrelation(backend, width, height, options)) {
    fine_.emplace(std::move(fine));
  }
  matches_.reserve(coarse_.peaks.size() + (fine_ ? fine_->peaks.size() : 0));
}

TileReference TileRegistration::MakeReference() const {
  return {.spectra = coarse_.correlation->MakeSpectra(),
          .fine_spectra = fine_ ? fine_->correlation->MakeSpectra() : nullptr};
}

void TileRegistration::SetReference(const GrayImage& picture, TileReference& reference) {
  coarse_.correlation->Transform(picture, kIdentity3, *reference.spectra);
  if (fine_) fine_->correlation->Transform(picture, kIdentity3, *reference.fine_spectra);
}

bool TileRegistration::HasTexture(const TileReference& reference) {
  auto& peaks = coarse_.peaks;
  coarse_.correlation->Correlate(*reference.spectra, *reference.spectra, peaks);
  const auto valid =
      std::count_if(peaks.begin(), peaks.end(), [](const TilePeak& p) { return p.valid; });
  return static_cast<double>(valid) >= LeastInliers(static_cast<double>(peaks.size()));
}

TileMeasurement TileRegistration::Measure(const TileReference& reference, const GrayImage& frame,
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

TileMeasurement TileRegistration::Refine(const TileMeasurement& measurement,
                                         const TileReference& reference, const GrayImage& frame) {
  if (!fine_ || measurement.quality == RegistrationQuality::kLost) return measurement;
  const Eigen::Matrix3d predicted = InverseHomography(measurement.reference_from_frame);
  matches_.clear();
  Match(coarse_, *reference.spectra, frame, predicted);
  Match(*fine_, *reference.fine_spectra, frame, predicted);
  TileMeasurement refined = measurement;
  if (const auto estimate = estimator_.Estimate(matches_)) SetEstimate(*estimate, refined);
  return refined;
}

void TileRegistration::Match(Layout& layout, const TileSpectra& reference, const GrayImage& frame,
                             const Eigen::Matrix3d& predicted_frame_from_reference) {
  PhaseCorrelation& correlation = *layout.correlation;
  correlation.Transform(frame, ToMatrix3(predicted_frame_from_reference), *layout.current);
  correlation.Correlate(reference, *layout.current, layout.peaks);
  for (std::size_t i = 0; i < layout.peaks.size(); ++i) {
    const TilePeak& peak = layout.peaks[i];
    if (!peak.valid) continue;
    const Eigen::Vector2d centre = Centre(correlation.settings(), i);
    const Eigen::Vector2d moved = centre + Eigen::Vector2d(peak.dx, peak.dy);
    matches_.push_back({.x_in_reference = centre,
                        .x_in_frame = Project(predicted_frame_from_reference, moved),
                        .covariance = Covariance(peak)});
  }
}

// The estimate's covariance is that of matches that err independently. Tiles do not: they share
// relief, compression and the grid of the pixels; and where many tiles disagree, some of those that
// agree do so by chance.
void TileRegistration::SetEstimate(const HomographyEstimate& estimate,
                                   TileMeasurement& measurement) const {
  // Measured on known motions of rendered flights and aerial stills under noise of 2, 5 and 10 grey
  // levels (the normalised corner errors of `bench registration`).
  constexpr double kDependence = 1.5;
  const double share = static_cast<double>(estimate.inliers) / static_cast<double>(matches_.size());
  measurement.reference_from_frame = estimate.reference_from_frame;
  measurement.corner_covariance = kDependence / (share * share) * estimate.corner_covariance;
  measurement.residual_px = estimate.residual_px;
  measurement.overlap =
      OverlapShare(estimate.reference_from_frame, width_, height_, width_, height_);
}

TileMeasurement TileRegistration::MeasureOnce(
    const TileReference& reference, const GrayImage& frame,
    const Eigen::Matrix3d& predicted_frame_from_reference) {
  matches_.clear();
  Match(coarse_, *reference.spectra, frame, predicted_frame_from_reference);
  TileMeasurement measurement;
  measurement.tiles = static_cast<int>(coarse_.peaks.size());
  const auto estimate = estimator_.Estimate(matches_);
  if (!estimate) return measurement;
  SetEstimate(*estimate, measurement);
  measurement.inliers = estimate->inliers;
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
  const auto& settings = coarse_.correlation->settings();
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
  if (measurement.inliers < LeastInliers(measurement.overlap * measurement.tiles))
    return RegistrationQuality::kLost;
  const bool valid = measurement.inliers > kMinimalMatches &&
                     measurement.inliers >= options_.min_inlier_share * peaks &&
                     measurement.residual_px <= options_.max_residual_px;
  return valid ? RegistrationQuality::kValid : RegistrationQuality::kDegraded;
}

}  // namespace windhover
