// SPDX-License-Identifier: Apache-2.0
#include "service/vision/homography_refiner.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix28d = Eigen::Matrix<double, 2, 8>;

// Both pictures are measured from the frame's centre, in units of half its larger side: entries of
// the homography are then of one size and h33 = 1 is a safe normalisation.
struct Scaling {
  Eigen::Matrix3d scaled_from_px;
  Eigen::Matrix3d px_from_scaled;
  double px_per_unit;

  Scaling(int width, int height) : px_per_unit(0.5 * std::max(width, height)) {
    const double cx = 0.5 * (width - 1);
    const double cy = 0.5 * (height - 1);
    const double s = 1.0 / px_per_unit;
    scaled_from_px << s, 0, -s * cx, 0, s, -s * cy, 0, 0, 1;
    px_from_scaled << px_per_unit, 0, cx, 0, px_per_unit, cy, 0, 0, 1;
  }
};

// d(projection) / d(h11 ... h32), h33 fixed.
Matrix28d JacobianOfParameters(const Eigen::Vector2d& x, const Eigen::Vector3d& projected) {
  const double w = 1.0 / projected.z();
  const double u = projected.x() * w;
  const double v = projected.y() * w;
  Matrix28d j;
  j << x.x(), x.y(), 1, 0, 0, 0, -u * x.x(), -u * x.y(),  //
      0, 0, 0, x.x(), x.y(), 1, -v * x.x(), -v * x.y();
  return j * w;
}

Eigen::Matrix2d JacobianOfPoint(const Eigen::Matrix3d& h, const Eigen::Vector3d& projected) {
  const double w = 1.0 / projected.z();
  const Eigen::Vector2d uv = projected.head<2>() * w;
  return (h.topLeftCorner<2, 2>() - uv * h.row(2).head<2>()) * w;
}

// A match under a homography.
struct Misfit {
  Eigen::Vector2d whitened;  // residual in units of its standard deviation: b = R a of eq. 2.27
  Matrix28d jacobian;        // of the projection by the parameters, whitened alike
};

// For a given homography the true points that minimise eq. 2.21 follow in closed form to first
// order, and what remains of the cost is the squared distance e = x' - P x in the metric of its
// covariance S' + A S A^T (A: derivative of P by the point): the Schur complement of the full
// system.
Misfit MisfitOf(const PointMatch& match, const Scaling& scaling, const Eigen::Matrix3d& h) {
  const Eigen::Vector2d x = Project(scaling.scaled_from_px, match.x_in_frame);
  const Eigen::Vector2d target = Project(scaling.scaled_from_px, match.x_in_reference);
  const Eigen::Vector3d projected = h * x.homogeneous();
  const Eigen::Matrix2d a = JacobianOfPoint(h, projected);
  const Eigen::Matrix2d half = 0.5 / (scaling.px_per_unit * scaling.px_per_unit) * match.covariance;
  const Eigen::LLT<Eigen::Matrix2d> factor(half + a * half * a.transpose());
  return {factor.matrixL().solve(target - projected.hnormalized()),
          factor.matrixL().solve(JacobianOfParameters(x, projected))};
}

// The normal equations in the homography alone.
struct NormalEquations {
  Matrix8d matrix = Matrix8d::Zero();
  Vector8d gradient = Vector8d::Zero();
  double cost = 0.0;
};

NormalEquations Build(std::span<const PointMatch> matches, std::span<const double> weights,
                      const Scaling& scaling, const Eigen::Matrix3d& h) {
  NormalEquations n;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const Misfit misfit = MisfitOf(matches[i], scaling, h);
    n.matrix.noalias() += weights[i] * misfit.jacobian.transpose() * misfit.jacobian;
    n.gradient.noalias() += weights[i] * misfit.jacobian.transpose() * misfit.whitened;
    n.cost += weights[i] * misfit.whitened.squaredNorm();
  }
  return n;
}

Eigen::Matrix3d Step(const Eigen::Matrix3d& h, const Vector8d& step) {
  Eigen::Matrix3d moved = h;
  moved.row(0) += step.segment<3>(0).transpose();
  moved.row(1) += step.segment<3>(3).transpose();
  moved.row(2).head<2>() += step.segment<2>(6).transpose();
  return moved;
}

Matrix8d CornerCovariance(const Eigen::Matrix3d& h, const Matrix8d& parameter_covariance,
                          const Scaling& scaling, int width, int height) {
  Matrix8d j;
  const auto corners = PictureCorners(width, height);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d x = Project(scaling.scaled_from_px, corners[i]);
    j.middleRows<2>(2 * i) = JacobianOfParameters(x, h * x.homogeneous()) * scaling.px_per_unit;
  }
  const Matrix8d covariance = j * parameter_covariance * j.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

// What the square of a distance is held against in the weight of a match.
double SquaredScale(const PointMatch& match, double scale_px) {
  return scale_px * scale_px + 2.0 * match.covariance.trace();
}

// How many times larger the variance of the result is than the matches' covariances say: that of an
// M-estimator with these weights (Huber, Robust Statistics, 7.6), for as many matches as the
// weights amount to. `squared_px` are the matches' squared distances.
double Scatter(std::span<const PointMatch> matches, std::span<const double> weights,
               std::span<const double> squared_px, const Scaling& scaling, const Eigen::Matrix3d& h,
               double scale_px) {
  double count = 0.0;
  double influence = 0.0;  // sum of the squared influences, in each coordinate
  double slope = 0.0;      // sum of their derivatives by the residual
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const double w = weights[i];
    if (w == 0.0) continue;
    count += w;
    influence += 0.5 * w * w * MisfitOf(matches[i], scaling, h).whitened.squaredNorm();
    const double s2 = SquaredScale(matches[i], scale_px);
    slope += std::isinf(s2) ? w : w * (s2 - squared_px[i]) / (s2 + squared_px[i]);
  }
  constexpr double kLeastSlope = 0.2;
  slope = std::max(slope, kLeastSlope * count);
  // Each match has two coordinates, the homography eight.
  const double freedom = count - 4.0;
  const double scatter =
      freedom > 0.0 ? influence * count * count / (freedom * slope * slope) : 1.0;
  return freedom < 4.0 ? std::max(scatter, 1.0) : scatter;
}

}  // namespace

HomographyRefiner::HomographyRefiner(int frame_width, int frame_height)
    : width_(frame_width), height_(frame_height) {}

double HomographyRefiner::Weigh(std::span<const PointMatch> matches, const Eigen::Matrix3d& h,
                                double scale_px) {
  constexpr double kFall = 0.6;
  constexpr double kLeastScalePx = 0.1;
  constexpr double kScalePerScatter = 2.0;
  constexpr double kMedianPerScatter = 1.1774;  // of the length of a normal 2-vector
  weights_.assign(matches.size(), 1.0);
  squared_distances_.assign(matches.size(), 0.0);
  if (std::isinf(scale_px)) return scale_px;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    squared_distances_[i] =
        (matches[i].x_in_reference - Project(h, matches[i].x_in_frame)).squaredNorm();
    if (!std::isfinite(squared_distances_[i])) {
      squared_distances_[i] = std::numeric_limits<double>::infinity();
      weights_[i] = 0.0;
      continue;
    }
    const double s2 = SquaredScale(matches[i], scale_px);
    weights_[i] = std::pow(s2 / (s2 + squared_distances_[i]), 2);
  }
  sorted_ = squared_distances_;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  const double floor_px =
      std::max(kLeastScalePx, kScalePerScatter / kMedianPerScatter * std::sqrt(*middle));
  return std::min(scale_px, std::max(kFall * scale_px, floor_px));
}

std::optional<HomographyFit> HomographyRefiner::Refine(std::span<const PointMatch> matches,
                                                       const Eigen::Matrix3d& initial,
                                                       double first_scale_px) {
  constexpr int kMostSteps = 20;
  const Scaling scaling(width_, height_);
  Eigen::Matrix3d h = scaling.scaled_from_px * initial * scaling.px_from_scaled;
  if (matches.empty() || !h.allFinite() || h(2, 2) == 0.0) return std::nullopt;
  h /= h(2, 2);
  const auto in_px = [&] { return scaling.px_from_scaled * h * scaling.scaled_from_px; };

  double scale_px = first_scale_px;
  double damping = 1e-6;
  NormalEquations n;
  for (int iteration = 0; iteration < kMostSteps; ++iteration) {
    const double next_scale_px = Weigh(matches, in_px(), scale_px);
    n = Build(matches, weights_, scaling, h);
    Matrix8d damped = n.matrix;
    damped.diagonal() *= 1.0 + damping;
    const Vector8d step = damped.ldlt().solve(n.gradient);
    if (!step.allFinite()) return std::nullopt;
    const Eigen::Matrix3d moved = Step(h, step);
    const NormalEquations next = Build(matches, weights_, scaling, moved);
    if (next.cost <= n.cost) {
      const bool settled = n.cost - next.cost <= 1e-6 * n.cost && next_scale_px > 0.95 * scale_px;
      h = moved;
      n = next;
      damping *= 0.1;
      if (settled) break;
      scale_px = next_scale_px;
    } else {
      damping = std::max(damping * 10.0, 1e-6);
      if (damping > 1e3) break;
    }
  }

  const Eigen::FullPivLU<Matrix8d> lu(n.matrix);
  if (!lu.isInvertible()) return std::nullopt;
  HomographyFit fit;
  fit.corner_covariance = CornerCovariance(
      h, Scatter(matches, weights_, squared_distances_, scaling, h, scale_px) * lu.inverse(),
      scaling, width_, height_);
  const Eigen::Matrix3d m = in_px();
  if (!m.allFinite() || std::abs(m(2, 2)) < 1e-12 || !fit.corner_covariance.allFinite()) {
    return std::nullopt;
  }
  fit.reference_from_frame = m / m(2, 2);
  return fit;
}

}  // namespace windhover
