// SPDX-License-Identifier: Apache-2.0
#include "service/vision/homography_mle.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

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

struct NormalEquations {
  Matrix8d matrix = Matrix8d::Zero();
  Vector8d gradient = Vector8d::Zero();
  double cost = 0.0;
  int used = 0;
};

// The normal equations in the homography alone. For a given homography the true points that
// minimise eq. 2.21 follow in closed form to first order, and what remains of the cost is the
// squared distance e = x' - P x in the metric of its covariance S' + A S A^T (A: derivative of P by
// the point): the Schur complement of the full system.
NormalEquations Build(std::span<const PointMatch> matches, std::span<const std::uint8_t> use,
                      const Scaling& scaling, const Eigen::Matrix3d& h) {
  NormalEquations n;
  const double to_units = 1.0 / (scaling.px_per_unit * scaling.px_per_unit);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (use[i] == 0) continue;
    const Eigen::Vector2d x = Project(scaling.scaled_from_px, matches[i].x_in_frame);
    const Eigen::Vector2d target = Project(scaling.scaled_from_px, matches[i].x_in_reference);
    const Eigen::Vector3d projected = h * x.homogeneous();
    const Eigen::Vector2d e = target - projected.hnormalized();
    const Eigen::Matrix2d a = JacobianOfPoint(h, projected);
    const Eigen::Matrix2d half = 0.5 * to_units * matches[i].covariance;
    const Eigen::LLT<Eigen::Matrix2d> factor(half + a * half * a.transpose());
    // b = R a of eq. 2.27: residual and Jacobian whitened by the Cholesky factor.
    const Eigen::Vector2d b = factor.matrixL().solve(e);
    const Matrix28d j = factor.matrixL().solve(JacobianOfParameters(x, projected));
    n.matrix.noalias() += j.transpose() * j;
    n.gradient.noalias() += j.transpose() * b;
    n.cost += b.squaredNorm();
    ++n.used;
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

}  // namespace

std::optional<HomographyFit> RefineHomography(std::span<const PointMatch> matches,
                                              std::span<const std::uint8_t> use,
                                              const Eigen::Matrix3d& initial, int frame_width,
                                              int frame_height) {
  const Scaling scaling(frame_width, frame_height);
  Eigen::Matrix3d h = scaling.scaled_from_px * initial * scaling.px_from_scaled;
  if (!h.allFinite() || h(2, 2) == 0.0) return std::nullopt;
  h /= h(2, 2);

  NormalEquations n = Build(matches, use, scaling, h);
  double damping = 1e-6;
  for (int iteration = 0; iteration < 15; ++iteration) {
    Matrix8d damped = n.matrix;
    damped.diagonal() *= 1.0 + damping;
    const Vector8d step = damped.ldlt().solve(n.gradient);
    if (!step.allFinite()) return std::nullopt;
    const Eigen::Matrix3d moved = Step(h, step);
    const NormalEquations next = Build(matches, use, scaling, moved);
    if (next.cost <= n.cost) {
      const bool settled = n.cost - next.cost <= 1e-9 * n.cost;
      h = moved;
      n = next;
      damping *= 0.1;
      if (settled) break;
    } else {
      damping = std::max(damping * 10.0, 1e-6);
      if (damping > 1e3) break;
    }
  }

  const Eigen::FullPivLU<Matrix8d> lu(n.matrix);
  if (!lu.isInvertible()) return std::nullopt;
  const int freedom = 2 * n.used - 8;
  double scatter = freedom > 0 ? n.cost / freedom : 1.0;
  if (freedom < 8) scatter = std::max(scatter, 1.0);

  HomographyFit fit;
  fit.corner_covariance =
      CornerCovariance(h, scatter * lu.inverse(), scaling, frame_width, frame_height);
  const Eigen::Matrix3d m = scaling.px_from_scaled * h * scaling.scaled_from_px;
  if (!m.allFinite() || std::abs(m(2, 2)) < 1e-12 || !fit.corner_covariance.allFinite()) {
    return std::nullopt;
  }
  fit.reference_from_frame = m / m(2, 2);
  return fit;
}

}  // namespace windhover
