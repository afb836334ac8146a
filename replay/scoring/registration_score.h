// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace windhover::replay {

// Homographies are known up to scale here: any factor but 0 gives the same result.

// Above this a frame counts as wrongly registered, px.
inline constexpr double kFailurePx = 2.0;

// Where two pictures show ground and not sky: (a, b, c) as in horizon.h; nothing: everywhere.
struct GroundSeen {
  std::optional<Eigen::Vector3d> in_a;
  std::optional<Eigen::Vector3d> in_b;
};

// RMS distance in px between where two homographies `b_from_a` put the ground of picture a, over
// all of a that truly lies on picture b too (thesis 2.4.4); both pictures are width x height px.
// Nothing where there is no such ground; infinite where the measured one sends any of it to
// infinity.
std::optional<double> RegistrationRms(const Eigen::Matrix3d& measured, const Eigen::Matrix3d& truth,
                                      int width, int height, const GroundSeen& ground = {});

struct RegistrationScore {
  // earlier_from_frame against truth, for frames 1 + gap, 2 + gap, ...; nothing for pairs that
  // truly show no common ground, which enter none of the figures below.
  std::vector<std::optional<double>> rms_px;
  int gap = 1;             // frames between the two of a pair
  int pairs = 0;           // that were scored
  int without_ground = 0;  // pairs that could not be
  // Nothing where no pair was scored.
  std::optional<double> mean_px;
  std::optional<double> median_px;
  std::optional<double> max_px;
  int failures = 0;  // frames over kFailurePx
  // Each frame as first_from_frame places it, against truth, in that frame's px, over all ground
  // that it shows; nothing for one that shows none. The first one's is 0.
  std::vector<std::optional<double>> drifts_px;
  // That of the last frame; 0 where there are no frames or it shows no ground.
  double drift_px = 0;
};

// Both hold first_from_frame of the same frames, in order. `horizons` (horizon.h) are empty or as
// many. Throws std::invalid_argument where their numbers differ and where `gap` is below 1.
RegistrationScore ScoreRegistration(const std::vector<Eigen::Matrix3d>& measured,
                                    const std::vector<Eigen::Matrix3d>& truth, int width,
                                    int height, int gap = 1,
                                    std::span<const Eigen::Vector3d> horizons = {});

}  // namespace windhover::replay
