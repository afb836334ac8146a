// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gpu-kernels/image.h"
#include "service/vision/photometry.h"

namespace windhover {

struct GainBiasFit {
  GainBias reference_from_frame;
  // Root mean square distance of the agreeing pixels from the fitted line, grey levels of either
  // picture.
  double residual = 0.0;
  // Share, 0 to 1, of the compared pixels that agree: those within three residuals of the line.
  double agreement = 0.0;
};

// Gain and bias between two registered pictures of one size (thesis 2.2.1, eq. 2.1), from all
// pixels where `mask`, where there is one, is not 0. Pixels of grey value 0 (no ground seen, see
// warp/warp.h) or 255 (clipped) in either picture do not take part.
//
// Both pictures carry noise, so the line's orthogonal distances are minimised: least squares on one
// picture would believe the other, and find too small a gain. The weights are Geman's and
// McClure's, with a scale that falls to the pixels' own scatter: things that are on one picture
// only do not move the result while the ground is in the majority.
//
// Nothing where fewer than 64 pixels can be compared, where the contrast does not stand out of the
// noise, or where the gain would not be positive. Throws std::invalid_argument where the sizes
// differ.
std::optional<GainBiasFit> FitGainBias(const GrayImage& reference, const GrayImage& frame,
                                       const GrayImage* mask = nullptr);

}  // namespace windhover
