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

}  // namespace

HomographyEstimator::HomographyEstimator(int frame_width, int frame_height,
                                         const HomographyEstimatorOptions& options)
    : width_(frame_width),
      height_(frame_height),
      options_(options),
      refiner_(frame_width, frame_height) {}

int HomographyEstimator::SelectInliers(std::span<const PointMatch> matches,
                                       const Eigen::Matrix3d& model, double threshold_px) {
  int count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const double squared_px =
        (matches[i].x_in_reference - Project(model, matches[i].x_in_frame)).squaredNorm();
    inliers_[i] = squared_px <= threshold_px * threshold_px ? 1 : 0;  // NaN is no inlier
    count += inliers_[i];
  }
  return count;
}

// MSAC: the score of a model is the sum of the squared distances, each cut off at the threshold.
bool HomographyEstimator::Ransac(std::span<const PointMatch> matches, Eigen::Matrix3d* best) {
  const double cut = options_.ransac_threshold_px * options_.ransac_threshold_px;
  const auto count = static_cast<std::uint32_t>(matches.size());
  std::minstd_rand random(12345);
  double best_score = std::numeric_limits<double>::infinity();
  int iterations = options_.max_ransac_iterations;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    std::array<const PointMatch*, 4> sample;
    for (std::size_t i = 0; i < sample.size();) {
      sample[i] = &matches[random() % count];
      if (std::find(sample.begin(), sample.begin() + i, sample[i]) == sample.begin() + i) ++i;
    }
    if (!IsGoodSample(sample)) continue;
    const auto model = HomographyOfFour(sample);
    if (!model) continue;
    double score = 0.0;
    int inliers = 0;
    for (const PointMatch& match : matches) {
      const double squared_px =
          (match.x_in_reference - Project(*model, match.x_in_frame)).squaredNorm();
      if (squared_px <= cut) ++inliers;
      score += squared_px <= cut ? squared_px : cut;
    }
    if (!(score < best_score)) continue;
    best_score = score;
    *best = *model;
    // Enough iterations to have drawn one clean sample with probability 0.999.
    const double clean = std::pow(static_cast<double>(inliers) / count, 4);
    if (clean >= 1.0 - 1e-9) break;
    if (clean > 1e-9) {
      const double enough = std::ceil(std::log(1e-3) / std::log1p(-clean));  // may pass any int
      iterations = static_cast<int>(std::min<double>(iterations, std::max(20.0, enough)));
    }
  }
  return std::isfinite(best_score);
}

std::optional<HomographyEstimate> HomographyEstimator::Estimate(
    std::span<const PointMatch> matches) {
  inliers_.assign(matches.size(), 0);
  Eigen::Matrix3d model;
  if (matches.size() < kMinimalMatches || !Ransac(matches, &model)) return std::nullopt;

  // Minimal samples extrapolate: the first least-squares fit takes matches a little further away.
  SelectInliers(matches, model, 1.5 * options_.ransac_threshold_px);
  const auto linear = HomographyByDlt(matches, inliers_);
  if (!linear) return std::nullopt;
  const auto fit = refiner_.Refine(matches, *linear, options_.ransac_threshold_px);
  if (!fit) return std::nullopt;
  const int count = SelectInliers(matches, fit->reference_from_frame, options_.ransac_threshold_px);
  if (count < kMinimalMatches) return std::nullopt;
  if (!IsOrientationPreserving(fit->reference_from_frame, width_, height_)) return std::nullopt;

  HomographyEstimate estimate;
  estimate.reference_from_frame = fit->reference_from_frame;
  estimate.corner_covariance = fit->corner_covariance;
  estimate.inliers = count;
  double sum = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (inliers_[i] == 0) continue;
    sum += (matches[i].x_in_reference - Project(fit->reference_from_frame, matches[i].x_in_frame))
               .squaredNorm();
  }
  estimate.residual_px = std::sqrt(sum / count);
  return estimate;
}

}  // namespace windhover
