// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "gpu-kernels/image.h"
#include "service/vision/block_residuals.h"
#include "service/vision/dual_step.h"
#include "service/vision/mask_pyramid.h"
#include "service/vision/photometry.h"
#include "service/vision/reference_blocks.h"
#include "service/vision/smooth_pyramid.h"

namespace windhover {

struct DualInverseCompositionalOptions {
  int most_iterations = 20;  // at each resolution, from 1 on
  // Largest move of a corner by a step at which it has converged, px; > 0.
  double convergence_px = 0.008;
  double min_overlap = 0.25;   // share, 0 to 1, of the reference that must lie on the frame
  double min_explained = 0.2;  // share, below 1, of its variance that the frame must explain
};

enum class DualOutcome : std::uint8_t {
  kConverged,
  kNotConverged,  // still moved after the last iteration; the values are the last ones
  // Not found; the homography and the photometry are the start's:
  kLittleOverlap,  // less of the reference lies on the frame than is asked for
  kNoTexture,      // what both see does not determine the parameters
  kNoAgreement,    // the pictures do not show the same, or a step led out of all bounds
};

// How a frame lies over a reference and what its grey values are there.
struct DualRegistration {
  DualOutcome outcome = DualOutcome::kNoAgreement;
  Eigen::Matrix3d reference_from_frame = Eigen::Matrix3d::Identity();  // points in px, h33 = 1
  GainBias photometry;  // reference value from frame value, grey levels
  // Weighted root mean square difference of the two (smoothed) pictures after registration, in
  // grey levels of the reference.
  double residual = 0.0;
  double overlap = 0.0;  // share, 0 to 1, of the reference's pixels that were compared
  int iterations = 0;    // at all resolutions together

  bool converged() const { return outcome == DualOutcome::kConverged; }
  // Whether there is a result at all, converged or not.
  bool found() const { return converged() || outcome == DualOutcome::kNotConverged; }
};

// Refines an eight-parameter homography together with a gain and a bias from all pixels of two
// pictures: dual inverse compositional registration (A. Bartoli, "Groupwise geometric and
// photometric direct image registration", 2008; thesis 2.3.2, eq. 2.13 to 2.15). Each step moves
// the reference under the inverse of what is sought, so that gradients and Jacobian products belong
// to the reference and are computed once for all frames. From coarse to fine; at the coarsest
// resolution a shift first, then an affinity. Blocks that disagree with the rest, as moving things
// do, lose their weight (see WeighBlocks).
//
// From a start that is within about a tenth of the picture it reaches hundredths of a pixel. Grey
// values at the ends of the range are taken to be clipped and do not take part. Keeps its working
// memory; one thread at a time.
class DualInverseCompositional {
 public:
  explicit DualInverseCompositional(const DualInverseCompositionalOptions& options = {});

  // `mask`, of the picture's size, is 0 where the reference does not take part; around it the
  // pixels do not either that the smoothing would mix with it. Throws std::invalid_argument for
  // sides under 32 px and where the sizes differ.
  void SetReference(const GrayImage& picture, const GrayImage* mask = nullptr);

  // The frame may have another size than the reference. Throws std::invalid_argument for sides
  // under 32 px, a start that is not finite and invertible or has no positive gain, and
  // std::logic_error before the first reference. Never throws for what the pictures show.
  DualRegistration Register(
      const GrayImage& frame,
      const Eigen::Matrix3d& initial_reference_from_frame = Eigen::Matrix3d::Identity(),
      const GainBias& initial_photometry = {});

 private:
  // The sought parameters p and q, in px of the pictures themselves.
  struct Estimate {
    Eigen::Matrix3d frame_from_reference;
    GainBias reference_from_frame;
  };
  struct LevelResult {
    DualOutcome outcome;
    Estimate estimate;
    double residual;
    double overlap;
    double explained_before;
    double explained;
    int iterations;
  };
  LevelResult RefineAtLevel(int level, const Estimate& start);

  DualInverseCompositionalOptions options_;
  std::vector<ReferenceBlocks> reference_;  // one a level, the finest first
  SmoothPyramid reference_pyramid_;
  SmoothPyramid frame_pyramid_;
  MaskPyramid mask_pyramid_;
  std::vector<BlockResidual> residuals_;
  std::vector<float> ratios_;
};

}  // namespace windhover
