// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace windhover::replay {

// Above this a frame counts as wrongly registered, px.
inline constexpr double kFailurePx = 2.0;

// RMS distance in px between where two homographies `b_from_a` put the ground of picture a, over
// all of a that truly lies on picture b too (thesis 2.4.4); both pictures are width x height px.
// Nothing where there is no such ground; infinite where the measured one sends any of it to
// infinity.
std::optional<double> RegistrationRms(const Eigen::Matrix3d& measured, const Eigen::Matrix3d& truth,
                                      int width, int height);

struct RegistrationScore {
  // previous_from_frame against truth, for frames 2, 3, ...; nothing for pairs that truly show no
  // common ground, which enter none of the figures below.
  std::vector<std::optional<double>> rms_px;
  int pairs = 0;           // that were scored
  int without_ground = 0;  // pairs that could not be
  // Nothing where no pair was scored.
  std::optional<double> mean_px;
  std::optional<double> max_px;
  int failures = 0;  // frames over kFailurePx
  // The last frame as first_from_frame places it, against truth, in that frame's px.
  double drift_px = 0;
};

// Both hold first_from_frame of the same frames, in order. Throws std::invalid_argument where their
// numbers differ.
RegistrationScore ScoreRegistration(const std::vector<Eigen::Matrix3d>& measured,
                                    const std::vector<Eigen::Matrix3d>& truth, int width,
                                    int height);

}  // namespace windhover::replay
