// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace windhover::replay {

// horizon.txt: one line a frame with the frame number from 1 and a, b, c, blank-separated, 17
// digits. Ground is where a * u + b * v + c > 0 for pixel centres (u, v) from 0; (a, b) is of
// length 1, so that the sum is the distance from the horizon in px.
//
// Entry i is (a, b, c) of frame i + 1. Reading makes (a, b) of length 1. Throws FormatError for the
// first malformed line or a frame out of turn.
std::vector<Eigen::Vector3d> ReadHorizons(const std::filesystem::path& file);
void WriteHorizons(const std::filesystem::path& file, const std::vector<Eigen::Vector3d>& horizons);

}  // namespace windhover::replay
