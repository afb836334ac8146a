// SPDX-License-Identifier: Apache-2.0
#include "service/vision/homography_estimator.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace windhover {
namespace {

double TwiceArea(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

// Four matches determine a homography when no three of their points lie on a line; those that also
// turn the other way round in the other picture belong to no view of a plane from one side.
bool IsGoodSample(const std::array<const PointMatch*, 4>& sample) {
  constexpr double kMinTwiceAreaPx2 = 50.0;
  static constexpr int kTriples[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  for (const auto& t : kTriples) {
    const double in_frame =
        TwiceArea(sample[t[0]]->x_in_frame, sample[t[1]]->x_in_frame, sample[t[2]]->x_in_frame);
    const double in_reference = TwiceArea(
        sample[t[0]]->x_in_reference, sample[t[1]]->x_in_reference, sample[t[2]]->x_in_reference);
    if (std::abs(in_frame) < kMinTwiceAreaPx2 || in_frame * in_reference <= 0.0) return false;
  }
  return true;
}

// The exact homography of four matches with h33 = 1, in coordinates relative to the first match so
// that the 8x8 system is well conditioned.
std::optional<Eigen::Matrix3d> HomographyOfFour(const std::array<const PointMatch*, 4>& sample) {
  constexpr double kScale = 1.0 / 128.0;
  const Eigen::Vector2d from = sample[0]->x_in_frame;
  const Eigen::Vector2d to = sample[0]->x_in_reference;
  Matrix8d a;
  Eigen::Matrix<double, 8, 1> b;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d x = (sample[i]->x_in_frame - from) * kScale;
    const Eigen::Vector2d u = (sample[i]->x_in_reference - to) * kScale;
    a.row(2 * i) << x.x(), x.y(), 1, 0, 0, 0, -u.x() * x.x(), -u.x() * x.y();
    a.row(2 * i + 1) << 0, 0, 0, x.x(), x.y(), 1, -u.y() * x.x(), -u.y() * x.y();
    b.segment<2>(2 * i) = u;
  }
  const Eigen::Matrix<double, 8, 1> h = a.partialPivLu().solve(b);
  if (!h.allFinite()) return std::nullopt;
  Eigen::Matrix3d m;
  m << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
  Eigen::Matrix3d relative_from_frame;
  relative_from_frame << kScale, 0, -kScale * from.x(), 0, kScale, -kScale * from.y(), 0, 0, 1;
  Eigen::Matrix3d reference_from_relative;
  reference_from_relative << 1 / kScale, 0, to.x(), 0, 1 / kScale, to.y(), 0, 0, 1;
  return Eigen::Matrix3d(reference_from_relative * m * relative_from_frame);
}

// Calls `consider` with the homographies of minimal samples; it returns how many samples will do
// from then on.
template <typename Consider>
void SampleHomographies(std::span<const PointMatch> matches, int samples, Consider&& consider) {
  const auto count = static_cast<std::uint32_t>(matches.size());
  std::minstd_rand random(12345);
  for (int drawn = 0; drawn < samples; ++drawn) {
    std::array<const PointMatch*, 4> sample;
    for (std::size_t i = 0; i < sample.size();) {
      sample[i] = &matches[random() % count];
      if (std::find(sample.begin(), sample.begin() + i, sample[i]) == sample.begin() + i) ++i;
    }
    if (!IsGoodSample(sample)) continue;
    if (const auto model = HomographyOfFour(sample)) samples = consider(*model);
  }
}

double SquaredDistance(const PointMatch& match, const Eigen::Matrix3d& model) {
  return (match.x_in_reference - Project(model, match.x_in_frame)).squaredNorm();
}

}  // namespace

HomographyEstimator::HomographyEstimator(int frame_width, int frame_height,
                                         const HomographyEstimatorOptions& options)
    : width_(frame_width),
      height_(frame_height),
      options_(options),
      refiner_(frame_width, frame_height),
      threshold_px_(options.ransac_threshold_px) {}

int HomographyEstimator::SelectInliers(std::span<const PointMatch> matches,
                                       const Eigen::Matrix3d& model, double threshold_px) {
  int count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const double squared_px = SquaredDistance(matches[i], model);
    inliers_[i] = squared_px <= threshold_px * threshold_px ? 1 : 0;  // NaN is no inlier
    count += inliers_[i];
  }
  return count;
}

// MSAC: the score of a model is the sum of the squared distances, each cut off at the threshold.
bool HomographyEstimator::Ransac(std::span<const PointMatch> matches, Eigen::Matrix3d* best) {
  threshold_px_ = options_.ransac_threshold_px;
  const double cut = threshold_px_ * threshold_px_;
  double best_score = std::numeric_limits<double>::infinity();
  int samples = options_.max_ransac_iterations;
  SampleHomographies(matches, samples, [&](const Eigen::Matrix3d& model) {
    double score = 0.0;
    int inliers = 0;
    for (const PointMatch& match : matches) {
      const double squared_px = SquaredDistance(match, model);
      if (squared_px <= cut) ++inliers;
      score += squared_px <= cut ? squared_px : cut;
    }
    if (!(score < best_score)) return samples;
    best_score = score;
    *best = model;
    // Enough samples to have drawn a clean one with probability 0.999.
    const double clean = std::pow(static_cast<double>(inliers) / matches.size(), 4);
    if (clean >= 1.0 - 1e-9) return samples = 0;
    if (clean > 1e-9) {
      const double enough = std::ceil(std::log(1e-3) / std::log1p(-clean));  // may pass any int
      samples = static_cast<int>(std::min<double>(samples, std::max(20.0, enough)));
    }
    return samples;
  });
  return std::isfinite(best_score);
}

// The score of a model is the median of the squared distances of the matches that it was not made
// of (thesis 2.3.1), which is sound while fewer than half of the matches are wrong.
bool HomographyEstimator::LeastMedian(std::span<const PointMatch> matches, Eigen::Matrix3d* best) {
  // Enough to have drawn a clean sample with probability 0.9999 where half of the matches are
  // wrong, and as many again: among clean samples, too, some are better than others.
  constexpr int kSamples = 300;
  constexpr double kMedianPerSigma = 1.1774;  // of the length of a normal 2-vector
  constexpr double kSigmas = 3.0;
  constexpr double kLeastThresholdPx = 0.1;
  const std::size_t rank = std::min(matches.size() - 1, (matches.size() + kMinimalMatches) / 2);
  double best_median = std::numeric_limits<double>::infinity();
  SampleHomographies(matches, kSamples, [&](const Eigen::Matrix3d& model) {
    squared_px_.clear();
    for (const PointMatch& match : matches) {
      const double squared_px = SquaredDistance(match, model);
      squared_px_.push_back(std::isfinite(squared_px) ? squared_px
                                                      : std::numeric_limits<double>::infinity());
    }
    const auto median = squared_px_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(squared_px_.begin(), median, squared_px_.end());
    if (*median < best_median) {
      best_median = *median;
      *best = model;
    }
    return kSamples;
  });
  // Few matches make the median look small (P. Rousseeuw and A. Leroy, 1987, chapter 5).
  const double few = 1.0 + 5.0 / std::max<double>(1.0, static_cast<double>(matches.size()) - 4.0);
  threshold_px_ = std::clamp(kSigmas * few * std::sqrt(best_median) / kMedianPerSigma,
                             std::min(kLeastThresholdPx, options_.ransac_threshold_px),
                             options_.ransac_threshold_px);
  return std::isfinite(best_median);
}

std::optional<HomographyEstimate> HomographyEstimator::Estimate(
    std::span<const PointMatch> matches) {
  inliers_.assign(matches.size(), 0);
  Eigen::Matrix3d model;
  if (matches.size() < kMinimalMatches) return std::nullopt;
  const bool found = options_.robust == RobustEstimator::kRansac ? Ransac(matches, &model)
                                                                 : LeastMedian(matches, &model);
  if (!found) return std::nullopt;

  // Minimal samples extrapolate: the first least-squares fit takes matches a little further away.
  SelectInliers(matches, model, 1.5 * threshold_px_);
  const auto linear = HomographyByDlt(matches, inliers_);
  if (!linear) return std::nullopt;
  return EstimateFrom(*linear, matches);
}

std::optional<HomographyEstimate> HomographyEstimator::EstimateFrom(
    const Eigen::Matrix3d& initial, std::span<const PointMatch> matches) {
  inliers_.assign(matches.size(), 0);
  const auto fit = refiner_.Refine(matches, initial, threshold_px_);
  if (!fit) return std::nullopt;
  const int count = SelectInliers(matches, fit->reference_from_frame, threshold_px_);
  if (count < kMinimalMatches) return std::nullopt;
  if (!IsOrientationPreserving(fit->reference_from_frame, width_, height_)) return std::nullopt;

  HomographyEstimate estimate;
  estimate.reference_from_frame = fit->reference_from_frame;
  estimate.corner_covariance = fit->corner_covariance;
  estimate.inliers = count;
  double sum = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (inliers_[i] != 0) sum += SquaredDistance(matches[i], fit->reference_from_frame);
  }
  estimate.residual_px = std::sqrt(sum / count);
  return estimate;
}

}  // namespace windhover
