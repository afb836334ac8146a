// SPDX-License-Identifier: Apache-2.0
#include "service/vision/homography.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover {
namespace {

// Moves the points' centroid to the origin and their RMS distance from it to sqrt(2).
struct Normalisation {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double scale = 0.0;

  Eigen::Vector2d operator()(const Eigen::Vector2d& x) const { return (x - centre) * scale; }
  Eigen::Matrix3d Matrix() const {
    Eigen::Matrix3d m;
    m << scale, 0, -scale * centre.x(), 0, scale, -scale * centre.y(), 0, 0, 1;
    return m;
  }
};

template <typename PointOf>
Normalisation Normalise(std::span<const PointMatch> matches, std::span<const std::uint8_t> use,
                        PointOf point_of) {
  Normalisation n;
  int count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!use.empty() && use[i] == 0) continue;
    n.centre += point_of(matches[i]);
    ++count;
  }
  n.centre /= std::max(count, 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!use.empty() && use[i] == 0) continue;
    sum += (point_of(matches[i]) - n.centre).squaredNorm();
  }
  n.scale = sum > 0.0 ? std::sqrt(2.0 * count / sum) : 0.0;
  return n;
}

}  // namespace

Eigen::Vector2d Project(const Eigen::Matrix3d& b_from_a, const Eigen::Vector2d& x_in_a) {
  return (b_from_a * x_in_a.homogeneous()).hnormalized();
}

Matrix3 ToMatrix3(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

Eigen::Matrix3d InverseHomography(const Eigen::Matrix3d& b_from_a) {
  const Eigen::Matrix3d inverse = b_from_a.inverse();
  return inverse / inverse(2, 2);
}

std::array<Eigen::Vector2d, 4> PictureCorners(int width, int height) {
  return {Eigen::Vector2d(0, 0), Eigen::Vector2d(width - 1, 0),
          Eigen::Vector2d(width - 1, height - 1), Eigen::Vector2d(0, height - 1)};
}

bool IsOrientationPreserving(const Eigen::Matrix3d& b_from_a, int width, int height) {
  if (!b_from_a.allFinite() || b_from_a.determinant() <= 0.0) return false;
  const auto corners = PictureCorners(width, height);
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& x) {
    return b_from_a.row(2).dot(x.homogeneous()) > 0.0;
  });
}

double OverlapShare(const Eigen::Matrix3d& b_from_a, int a_width, int a_height, int b_width,
                    int b_height) {
  constexpr int kPoints = 24;
  int inside = 0;
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d x = b_from_a * Eigen::Vector3d((i + 0.5) * a_width / kPoints - 0.5,
                                                           (j + 0.5) * a_height / kPoints - 0.5, 1);
      const double u = x.x() / x.z();
      const double v = x.y() / x.z();
      if (x.z() > 0.0 && u >= 0.0 && v >= 0.0 && u <= b_width - 1 && v <= b_height - 1) ++inside;
    }
  }
  return static_cast<double>(inside) / (kPoints * kPoints);
}

std::optional<Eigen::Matrix3d> HomographyByDlt(std::span<const PointMatch> matches,
                                               std::span<const std::uint8_t> use) {
  const Normalisation n_frame =
      Normalise(matches, use, [](const PointMatch& m) { return m.x_in_frame; });
  const Normalisation n_reference =
      Normalise(matches, use, [](const PointMatch& m) { return m.x_in_reference; });
  if (n_frame.scale == 0.0 || n_reference.scale == 0.0) return std::nullopt;

  Eigen::Matrix<double, 9, 9> ata = Eigen::Matrix<double, 9, 9>::Zero();
  int count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!use.empty() && use[i] == 0) continue;
    const Eigen::Vector2d x = n_frame(matches[i].x_in_frame);
    const Eigen::Vector2d u = n_reference(matches[i].x_in_reference);
    Eigen::Matrix<double, 2, 9> a;
    a << x.x(), x.y(), 1, 0, 0, 0, -u.x() * x.x(), -u.x() * x.y(), -u.x(),  //
        0, 0, 0, x.x(), x.y(), 1, -u.y() * x.x(), -u.y() * x.y(), -u.y();
    ata.noalias() += a.transpose() * a;
    ++count;
  }
  if (count < kMinimalMatches) return std::nullopt;

  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(ata);
  // A second vanishing eigenvalue means a family of homographies: the points are degenerate.
  constexpr double kRelativeRank = 1e-10;
  if (solver.info() != Eigen::Success ||
      solver.eigenvalues()[1] < kRelativeRank * solver.eigenvalues()[8]) {
    return std::nullopt;
  }
  const auto h = solver.eigenvectors().col(0);
  Eigen::Matrix3d m;
  m << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  m = n_reference.Matrix().inverse() * m * n_frame.Matrix();
  if (!m.allFinite() || std::abs(m(2, 2)) < std::numeric_limits<double>::epsilon()) {
    return std::nullopt;
  }
  return Eigen::Matrix3d(m / m(2, 2));
}

}  // namespace windhover
