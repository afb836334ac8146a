// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "replay/readers/recording.h"

namespace windhover::replay {

// Components of moving pixels smaller than this in either direction do not count, px.
inline constexpr int kLeastMaskSide = 3;

// The labels of frame `frame` after CDnet's mask of it, CV_8UC1: 0 stands still, 50 is a shadow and
// does too, 85 lies outside the region that is judged, 170 is unknown, 255 moves. One box for each
// component (of eight neighbours) of 255; boxes that do not count cover 85 and 170 exactly. Throws
// FormatError, naming `file`, for any other value.
std::vector<Label> BoxesOfMask(const std::filesystem::path& file, const cv::Mat& mask, int frame);

}  // namespace windhover::replay
