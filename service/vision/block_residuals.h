// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "service/vision/photometry.h"
#include "service/vision/reference_blocks.h"
#include "service/vision/smooth_pyramid.h"

namespace windhover {

// How one block of the reference differs from a frame under a homography and a gain and bias: sums
// over the block's pixels of the residual e = gain * I(W x) + bias - T(x), in grey levels.
struct BlockResidual {
  std::array<float, kDualParameters> gradient;  // the Jacobian's rows times e
  float squared;                                // e^2
  float pixels;  // that could be compared; 0 where the block does not lie wholly on the frame
};

// For each block its residual. The homography is in px of this level; I is interpolated linearly.
// A pixel that falls on a clipped place of the frame counts as one without a residual.
void ComputeResiduals(const ReferenceBlocks& reference, const FloatPicture& frame,
                      const Eigen::Matrix3d& frame_from_reference,
                      const GainBias& reference_from_frame, std::span<BlockResidual> residuals);

}  // namespace windhover
