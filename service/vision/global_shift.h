// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"

namespace windhover {

// Global 2-DOF pre-registration (thesis 2.4.3): the shift between one frame and the next from phase
// correlation of the whole, reduced picture. Reaches about half the picture. One thread at a time.
class GlobalShift {
 public:
  GlobalShift(Backend& backend, int width, int height);

  // What lies at x in the previous frame lies at about x + shift in this one, px of the full
  // picture. Nothing for the first frame after construction or Reset, or where there is no clear
  // peak.
  std::optional<Eigen::Vector2d> Next(const GrayImage& frame);
  void Reset() { has_previous_ = false; }

 private:
  int factor_;
  std::unique_ptr<Decimate> decimate_;
  GrayImage reduced_;
  std::unique_ptr<PhaseCorrelation> correlation_;
  std::unique_ptr<TileSpectra> previous_;
  std::unique_ptr<TileSpectra> current_;
  bool has_previous_ = false;
};

}  // namespace windhover
