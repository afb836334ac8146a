// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace windhover {

// The operators' .cl files, word for word, embedded by deploy/cmake/EmbedKernels.cmake. Each begins
// with a #line that makes compiler messages name the file.
extern const std::string_view kBilinearCl;
extern const std::string_view kDecimateCl;
extern const std::string_view kDifferenceThresholdCl;
extern const std::string_view kFindPeakCl;
extern const std::string_view kLanesCl;
extern const std::string_view kSampleTilesCl;
extern const std::string_view kTemporalMedianCl;
extern const std::string_view kTransformCl;
extern const std::string_view kWarpCl;

}  // namespace windhover
