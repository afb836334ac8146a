// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/registration_score.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace windhover::replay {
namespace {

constexpr int kGridPx = 8;

// Calls visit(point) for points all over the picture, its border included.
template <typename Visit>
void ForEachGridPoint(int width, int height, Visit&& visit) {
  const int columns = std::max(1, (width - 1) / kGridPx);
  const int rows = std::max(1, (height - 1) / kGridPx);
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      visit(Eigen::Vector2d(static_cast<double>(column) * (width - 1) / columns,
                            static_cast<double>(row) * (height - 1) / rows));
    }
  }
}

}  // namespace

std::optional<double> RegistrationRms(const Eigen::Matrix3d& measured, const Eigen::Matrix3d& truth,
                                      int width, int height) {
  double sum = 0;
  int points = 0;
  ForEachGridPoint(width, height, [&](const Eigen::Vector2d& point) {
    const Eigen::Vector3d there = truth * point.homogeneous();
    if (there.z() <= 0) return;
    const Eigen::Vector2d true_place = there.hnormalized();
    if (true_place.x() < 0 || true_place.y() < 0 || true_place.x() > width - 1 ||
        true_place.y() > height - 1) {
      return;
    }
    const Eigen::Vector3d found = measured * point.homogeneous();
    sum += found.z() > 0 ? (found.hnormalized() - true_place).squaredNorm()
                         : std::numeric_limits<double>::infinity();
    ++points;
  });
  if (points == 0) return std::nullopt;
  return std::sqrt(sum / points);
}

RegistrationScore ScoreRegistration(const std::vector<Eigen::Matrix3d>& measured,
                                    const std::vector<Eigen::Matrix3d>& truth, int width,
                                    int height) {
  if (measured.size() != truth.size()) {
    throw std::invalid_argument("there are homographies of " + std::to_string(measured.size()) +
                                " frames, but truth for " + std::to_string(truth.size()));
  }
  const auto normalised = [](const Eigen::Matrix3d& matrix) {
    return Eigen::Matrix3d(matrix / matrix(2, 2));
  };
  RegistrationScore score;
  if (truth.empty()) return score;
  double sum = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const std::optional<double> rms =
        RegistrationRms(normalised(measured[i - 1].inverse() * measured[i]),
                        normalised(truth[i - 1].inverse() * truth[i]), width, height);
    score.rms_px.push_back(rms);
    if (!rms) {
      ++score.without_ground;
      continue;
    }
    ++score.pairs;
    sum += *rms;
    score.max_px = std::max(score.max_px.value_or(0), *rms);
    if (*rms > kFailurePx) ++score.failures;
  }
  if (score.pairs > 0) score.mean_px = sum / score.pairs;
  // A picture always has all of its ground in common with itself.
  score.drift_px = RegistrationRms(normalised(truth.back().inverse() * truth.front() *
                                              measured.front().inverse() * measured.back()),
                                   Eigen::Matrix3d::Identity(), width, height)
                       .value();
  return score;
}

}  // namespace windhover::replay
