// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/registration_score.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "replay/scoring/oriented.h"
#include "replay/scoring/summary.h"

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

bool IsGround(const std::optional<Eigen::Vector3d>& horizon, const Eigen::Vector2d& point) {
  return !horizon || horizon->dot(point.homogeneous()) > 0;
}

void CheckNumbers(std::size_t measured, std::size_t truth, std::size_t horizons, int gap) {
  if (measured != truth) {
    throw std::invalid_argument("there are homographies of " + std::to_string(measured) +
                                " frames, but truth for " + std::to_string(truth));
  }
  if (horizons != 0 && horizons != truth) {
    throw std::invalid_argument("there are horizons of " + std::to_string(horizons) +
                                " frames, but truth for " + std::to_string(truth));
  }
  if (gap < 1) throw std::invalid_argument("a gap is of at least 1 frame");
}

void Summarise(RegistrationScore& score) {
  const Summary summary = SummaryOf(score.rms_px);
  score.pairs = summary.count;
  score.without_ground = static_cast<int>(score.rms_px.size()) - summary.count;
  score.mean_px = summary.mean;
  score.median_px = summary.median;
  score.max_px = summary.largest;
  score.failures = static_cast<int>(
      std::count_if(score.rms_px.begin(), score.rms_px.end(),
                    [](const std::optional<double>& rms) { return rms && *rms > kFailurePx; }));
}

}  // namespace

std::optional<double> RegistrationRms(const Eigen::Matrix3d& measured, const Eigen::Matrix3d& truth,
                                      int width, int height, const GroundSeen& ground) {
  const Eigen::Matrix3d measured_in_front = Oriented(measured);
  const Eigen::Matrix3d truth_in_front = Oriented(truth);
  double sum = 0;
  int points = 0;
  ForEachGridPoint(width, height, [&](const Eigen::Vector2d& point) {
    const Eigen::Vector3d there = truth_in_front * point.homogeneous();
    if (!IsGround(ground.in_a, point) || there.z() <= 0) return;
    const Eigen::Vector2d true_place = there.hnormalized();
    if (true_place.x() < 0 || true_place.y() < 0 || true_place.x() > width - 1 ||
        true_place.y() > height - 1 || !IsGround(ground.in_b, true_place)) {
      return;
    }
    const Eigen::Vector3d found = measured_in_front * point.homogeneous();
    sum += found.z() > 0 ? (found.hnormalized() - true_place).squaredNorm()
                         : std::numeric_limits<double>::infinity();
    ++points;
  });
  if (points == 0) return std::nullopt;
  return std::sqrt(sum / points);
}

RegistrationScore ScoreRegistration(const std::vector<Eigen::Matrix3d>& measured,
                                    const std::vector<Eigen::Matrix3d>& truth, int width,
                                    int height, int gap,
                                    std::span<const Eigen::Vector3d> horizons) {
  CheckNumbers(measured.size(), truth.size(), horizons.size(), gap);
  const auto horizon = [&](std::size_t frame) {
    return horizons.empty() ? std::nullopt : std::optional<Eigen::Vector3d>(horizons[frame]);
  };
  RegistrationScore score;
  score.gap = gap;
  for (std::size_t i = static_cast<std::size_t>(gap); i < truth.size(); ++i) {
    const std::size_t earlier = i - static_cast<std::size_t>(gap);
    score.rms_px.push_back(RegistrationRms(measured[earlier].inverse() * measured[i],
                                           truth[earlier].inverse() * truth[i], width, height,
                                           {horizon(i), horizon(earlier)}));
  }
  Summarise(score);
  // Where truth puts the frame again after the measurement has taken it to the first one.
  for (std::size_t i = 0; i < truth.size(); ++i) {
    score.drifts_px.push_back(RegistrationRms(
        truth[i].inverse() * truth.front() * measured.front().inverse() * measured[i],
        Eigen::Matrix3d::Identity(), width, height, {horizon(i), horizon(i)}));
  }
  if (!score.drifts_px.empty()) score.drift_px = score.drifts_px.back().value_or(0);
  return score;
}

}  // namespace windhover::replay
