// SPDX-License-Identifier: Apache-2.0
#include "service/vision/dual_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

using Vector55d = Eigen::Matrix<double, kDualProducts, 1>;

// Mean squared residual of a block over that of noise and of texture that lies a little off.
float ResidualRatio(const ReferenceBlock& block, const BlockResidual& residual) {
  constexpr float kNoise = 2.0F;   // grey levels
  constexpr float kOffset = 0.1F;  // px
  const float expected = kNoise * kNoise + kOffset * kOffset * block.squared_slope;
  return residual.squared / (residual.pixels * expected);
}

// The median ratio of textured blocks: flat ground fits everywhere and says nothing.
float MedianRatio(const ReferenceBlocks& reference, std::span<const BlockResidual> residuals,
                  std::vector<float>& ratios) {
  ratios.clear();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const ReferenceBlock& block = reference.blocks[i];
    if (block.textured && residuals[i].pixels > 0.0F) {
      ratios.push_back(ResidualRatio(block, residuals[i]));
    }
  }
  if (ratios.empty()) return 1.0F;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  constexpr float kLeast = 1e-4F;
  return std::max(*middle, kLeast);
}

}  // namespace

DualEquations WeighBlocks(const ReferenceBlocks& reference,
                          std::span<const BlockResidual> residuals, std::vector<float>& ratios) {
  constexpr float kMediansAtHalfRoot = 2.0F;
  const float scale = kMediansAtHalfRoot * MedianRatio(reference, residuals, ratios);
  DualEquations equations;
  equations.gradient.setZero();
  Vector55d products = Vector55d::Zero();
  double weights = 0.0, weighted = 0.0, squared = 0.0, sum = 0.0, sum_of_squares = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BlockResidual& residual = residuals[i];
    if (residual.pixels == 0.0F) continue;
    const ReferenceBlock& block = reference.blocks[i];
    const float root = scale / (scale + ResidualRatio(block, residual));
    const double weight = root * root;
    // Pixels that were clipped in the frame are missing from the residual, so let them be missing
    // here, on average.
    const double share = residual.pixels / block.pixels;
    products += weight * share *
                Eigen::Map<const Eigen::Matrix<float, kDualProducts, 1>>(block.products.data())
                    .cast<double>();
    equations.gradient += weight * Eigen::Map<const Eigen::Matrix<float, kDualParameters, 1>>(
                                       residual.gradient.data())
                                       .cast<double>();
    weights += weight * residual.pixels;
    weighted += weight * residual.squared;
    equations.pixels += residual.pixels;
    squared += residual.squared;
    sum += share * block.products[1];                           // of 1 * T
    sum_of_squares += share * block.products[kDualParameters];  // of T * T
  }
  int product = 0;
  for (int a = 0; a < kDualParameters; ++a) {
    for (int b = a; b < kDualParameters; ++b, ++product) {
      equations.matrix(a, b) = equations.matrix(b, a) = products[product];
    }
  }
  if (equations.pixels > 0.0) {
    equations.mean_square = weighted / weights;
    const double variance = sum_of_squares - sum * sum / equations.pixels;
    equations.explained = variance > 0.0 ? 1.0 - squared / variance : 0.0;
  }
  return equations;
}

std::optional<DualStep> SolveStep(const DualEquations& equations, int parameters,
                                  const ScaledCoordinates& scaled) {
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kDualParameters, kDualParameters>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kDualParameters, 1>;
  constexpr double kLeastCondition = 1e-8;
  Matrix matrix = equations.matrix.topLeftCorner(parameters, parameters);
  if (!(matrix.diagonal().array() > 0.0).all()) return std::nullopt;
  const Vector unit = matrix.diagonal().array().rsqrt().matrix();
  matrix = unit.asDiagonal() * matrix * unit.asDiagonal();
  const Eigen::LDLT<Matrix> factor(matrix);
  if (factor.info() != Eigen::Success || !factor.isPositive() || factor.rcond() < kLeastCondition) {
    return std::nullopt;
  }
  Eigen::Matrix<double, kDualParameters, 1> d = Eigen::Matrix<double, kDualParameters, 1>::Zero();
  const Vector scaled_gradient = unit.cwiseProduct(equations.gradient.head(parameters));
  const Vector solution = factor.solve(scaled_gradient);
  d.head(parameters) = unit.cwiseProduct(solution);
  if (!d.allFinite()) return std::nullopt;
  Eigen::Matrix3d warp;
  warp << 1.0 + d[4], d[5], d[2], d[6], 1.0 + d[7], d[3], d[8], d[9], 1.0;
  return DualStep{scaled.PxFromScaled() * warp * scaled.ScaledFromPx(), {1.0 + d[1], d[0]}};
}

}  // namespace windhover
