// SPDX-License-Identifier: Apache-2.0
#include "service/vision/dual_inverse_compositional.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "service/vision/homography.h"

namespace windhover {
namespace {

constexpr int kLeastSidePx = 32;
constexpr int kLeastCoarseSidePx = 48;  // that a coarser level must still have

void CheckSize(const GrayImage& picture, const char* name) {
  if (std::min(picture.width(), picture.height()) < kLeastSidePx) {
    throw std::invalid_argument(std::string(name) + " of " + std::to_string(picture.width()) + "x" +
                                std::to_string(picture.height()) + " px has a side under " +
                                std::to_string(kLeastSidePx) + " px");
  }
}

int LevelCount(int width, int height) {
  int levels = 1;
  for (int side = std::min(width, height); (side + 1) / 2 >= kLeastCoarseSidePx;
       side = (side + 1) / 2) {
    ++levels;
  }
  return levels;
}

// px of the picture from px of a level.
Eigen::Matrix3d PictureFromLevel(int level) {
  const double factor = std::ldexp(1.0, level);
  return Eigen::Vector3d(factor, factor, 1.0).asDiagonal();
}

// Largest distance by which the warp moves a corner of the picture, px.
double CornerMove(const Eigen::Matrix3d& warp, int width, int height) {
  double most = 0.0;
  for (const Eigen::Vector2d& corner : PictureCorners(width, height)) {
    most = std::max(most, (Project(warp, corner) - corner).norm());
  }
  return most;
}

// V(., q) <- V(., dq)^-1 o V(., q): the photometric counterpart of the inverse composition.
GainBias Compose(const GainBias& q, const GainBias& dq) {
  return {q.gain / dq.gain, (q.bias - dq.bias) / dq.gain};
}

bool IsPlausible(const GainBias& q) {
  constexpr double kMostGain = 16.0;
  return std::isfinite(q.bias) && q.gain > 1.0 / kMostGain && q.gain < kMostGain;
}

// Takes the step in p and q; false where it leads out of all bounds. The homography `h` becomes
// W(x, p) o W(x, dp)^-1, the photometric warp likewise.
bool Move(const DualStep& step, int width, int height, Eigen::Matrix3d& h, GainBias& q) {
  if (!IsOrientationPreserving(step.warp, width, height) || step.photometric.gain <= 0.0) {
    return false;
  }
  h = h * step.warp.inverse();
  h /= h(2, 2);
  q = Compose(q, step.photometric);
  return IsOrientationPreserving(h, width, height) && IsPlausible(q);
}

}  // namespace

DualInverseCompositional::DualInverseCompositional(const DualInverseCompositionalOptions& options)
    : options_(options) {}

void DualInverseCompositional::SetReference(const GrayImage& picture, const GrayImage* mask) {
  CheckSize(picture, "a reference");
  if (mask != nullptr && (mask->width() != picture.width() || mask->height() != picture.height())) {
    throw std::invalid_argument("a reference and its mask differ in size");
  }
  const int levels = LevelCount(picture.width(), picture.height());
  reference_pyramid_.Build(picture, levels);
  reference_.resize(levels);
  mask_pyramid_.Build(mask, levels);
  for (int level = 0; level < levels; ++level) {
    CutIntoBlocks(reference_pyramid_.level(level), mask_pyramid_.level(level), reference_[level]);
  }
}

DualInverseCompositional::LevelResult DualInverseCompositional::RefineAtLevel(
    int level, const Estimate& start) {
  const ReferenceBlocks& reference = reference_[level];
  const FloatPicture& frame = frame_pyramid_.level(level);
  const Eigen::Matrix3d picture_from_level = PictureFromLevel(level);
  const Eigen::Matrix3d level_from_picture = picture_from_level.inverse();
  const bool coarsest = level > 0 && level + 1 == static_cast<int>(reference_.size());
  // What a coarse level leaves undone the next one does.
  constexpr double kCoarseConvergencePx = 0.03;
  const double convergence_px = level == 0 ? options_.convergence_px : kCoarseConvergencePx;

  LevelResult result{DualOutcome::kNotConverged, start, 0.0, 0.0, 0.0, 0.0, 0};
  Eigen::Matrix3d h = level_from_picture * start.frame_from_reference * picture_from_level;
  GainBias q = start.reference_from_frame;
  residuals_.resize(reference.blocks.size());
  int parameters = coarsest ? 4 : kDualParameters;
  while (result.iterations < options_.most_iterations) {
    ComputeResiduals(reference, frame, h, q, residuals_);
    const DualEquations equations = WeighBlocks(reference, residuals_, ratios_);
    result.overlap = reference.pixels > 0.0 ? equations.pixels / reference.pixels : 0.0;
    result.residual = std::sqrt(equations.mean_square);
    result.explained = equations.explained;
    if (result.iterations == 0) result.explained_before = equations.explained;
    if (result.overlap < options_.min_overlap) {
      result.outcome = DualOutcome::kLittleOverlap;
      return result;
    }
    const std::optional<DualStep> step = SolveStep(equations, parameters, reference.scaled);
    if (!step) {
      result.outcome = DualOutcome::kNoTexture;
      return result;
    }
    ++result.iterations;
    if (!Move(*step, reference.width, reference.height, h, q)) {
      result.outcome = DualOutcome::kNoAgreement;
      return result;
    }
    if (CornerMove(step->warp, reference.width, reference.height) > convergence_px) continue;
    if (parameters == kDualParameters) {
      result.outcome = DualOutcome::kConverged;
      break;
    }
    parameters = parameters == 4 ? 8 : kDualParameters;
  }
  result.estimate = {picture_from_level * h * level_from_picture, q};
  return result;
}

DualRegistration DualInverseCompositional::Register(
    const GrayImage& frame, const Eigen::Matrix3d& initial_reference_from_frame,
    const GainBias& initial_photometry) {
  if (reference_.empty()) throw std::logic_error("a frame comes before the reference");
  CheckSize(frame, "a frame");
  const Eigen::Matrix3d inverse = initial_reference_from_frame.inverse();
  if (!inverse.allFinite() || inverse(2, 2) == 0.0 || initial_reference_from_frame(2, 2) == 0.0) {
    throw std::invalid_argument("the start of a registration is no homography");
  }
  if (!(initial_photometry.gain > 0.0) || !std::isfinite(initial_photometry.gain) ||
      !std::isfinite(initial_photometry.bias)) {
    throw std::invalid_argument("the start of a registration has no positive gain");
  }
  const int levels = static_cast<int>(reference_.size());
  frame_pyramid_.Build(frame, levels);

  Estimate estimate{inverse / inverse(2, 2), initial_photometry};
  DualRegistration registration;
  registration.reference_from_frame =
      initial_reference_from_frame / initial_reference_from_frame(2, 2);
  registration.photometry = initial_photometry;
  for (int level = levels - 1; level >= 0; --level) {
    const LevelResult result = RefineAtLevel(level, estimate);
    registration.iterations += result.iterations;
    registration.outcome = result.outcome;
    if (level > 0) {
      // A coarse level that has lost its way is as if it had not been there.
      if (registration.found() && result.explained >= result.explained_before) {
        estimate = result.estimate;
      }
      continue;
    }
    registration.residual = result.residual;
    registration.overlap = result.overlap;
    if (!registration.found()) break;
    if (result.explained < options_.min_explained) {
      registration.outcome = DualOutcome::kNoAgreement;
      break;
    }
    registration.reference_from_frame = InverseHomography(result.estimate.frame_from_reference);
    registration.photometry = result.estimate.reference_from_frame;
  }
  return registration;
}

}  // namespace windhover
