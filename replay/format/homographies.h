// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace windhover::replay {

// homography.txt: one line a frame with the frame number from 1 and the nine numbers of
// first_from_frame, row-major, 17 digits, blank-separated. It takes pixels of the frame to pixels
// of the sequence's first frame; pixel centres lie at 0-based integers.

// Entry i belongs to frame i + 1. Throws FormatError for the first malformed line, a frame out of
// turn or a matrix without an inverse.
std::vector<Eigen::Matrix3d> ReadHomographies(const std::filesystem::path& file);
void WriteHomographies(const std::filesystem::path& file,
                       const std::vector<Eigen::Matrix3d>& first_from_frame);

}  // namespace windhover::replay
