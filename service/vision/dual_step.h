// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "service/vision/block_residuals.h"
#include "service/vision/photometry.h"
#include "service/vision/reference_blocks.h"

namespace windhover {

// The normal equations of one step over all blocks, and what the blocks say of the fit.
struct DualEquations {
  Eigen::Matrix<double, kDualParameters, kDualParameters> matrix;
  Eigen::Matrix<double, kDualParameters, 1> gradient;
  // Weighted mean square of the residual, grey levels^2.
  double mean_square = 0.0;
  // Reference pixels that were compared.
  double pixels = 0.0;
  // Share of the reference's variance over them that the frame explains, without weights: 1 where
  // the pictures are equal, 0 or less where they have nothing in common.
  double explained = 0.0;
};

// Weighs each block as a whole by Geman's and McClure's function of its mean squared residual, held
// against what noise and a small shift of its own texture would make of it, and against the
// median of that ratio over the picture: things that move or stand out of the ground count little
// (thesis 2.3.2 leaves all weights at 1). `ratios` is working memory.
DualEquations WeighBlocks(const ReferenceBlocks& reference,
                          std::span<const BlockResidual> residuals, std::vector<float>& ratios);

// An update of the reference: W(x, dp) in px of its level, and V(a, dq).
struct DualStep {
  Eigen::Matrix3d warp;
  GainBias photometric;
};

// Solves for the first `parameters` of the ten: 4 are a shift, 8 an affinity, 10 a homography.
// Nothing where the blocks do not determine them.
std::optional<DualStep> SolveStep(const DualEquations& equations, int parameters,
                                  const ScaledCoordinates& scaled);

}  // namespace windhover
