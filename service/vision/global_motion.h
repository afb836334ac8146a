// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"

namespace windhover {

// Global pre-registration (thesis 2.4.3) by phase correlation of whole, reduced pictures. One
// thread at a time.
class GlobalMotion {
 public:
  GlobalMotion(Backend& backend, int width, int height);

  // The shift between one frame and the next: what lies at x in the previous frame lies at about
  // x + shift in this one, px of the full picture. Reaches about half the picture. Nothing for the
  // first frame after construction or Reset, or where there is no clear peak.
  std::optional<Eigen::Vector2d> NextShift(const GrayImage& frame);

  // Whether the two frames of the last NextShift are the same picture, but for what averages out
  // where they are reduced.
  bool Repeats() const;

  // Whether the two frames of the last NextShift, laid over each other by a homography, show the
  // same: their correlation then has a clear peak at no shift, to half a pixel of the reduced
  // pictures. Of a street registered to the next one alike it peaks a street away.
  bool Confirms(const Eigen::Matrix3d& frame_from_previous);

  // For the two frames of the last NextShift: where the camera may have gone if it has also turned
  // about its axis by up to 12 degrees or zoomed by up to an eighth, the likeliest first. Tries 65
  // turns and zooms, each at the price of a NextShift; the true one among the found is right to
  // about a degree and 3 %. Valid until the next call.
  std::span<const Eigen::Matrix3d> SearchTurnsAndZooms();

  void Reset() { has_previous_ = false; }

 private:
  struct Candidate {
    Eigen::Matrix3d frame_from_previous;
    float clearness = 0.0F;  // of the peak: its height over the noise
  };
  Candidate Try(double radians, double zoom);
  Eigen::Matrix3d ReducedTurn(double radians, double zoom) const;
  // Of the previous reduced frame with this one, sampled under a homography between them.
  TilePeak CorrelateUnder(const Eigen::Matrix3d& frame_from_previous);

  int factor_;
  Eigen::Matrix3d full_from_reduced_;
  Eigen::Matrix3d reduced_from_full_;
  std::unique_ptr<Decimate> decimate_;
  GrayImage reduced_;
  GrayImage previous_reduced_;
  std::unique_ptr<PhaseCorrelation> correlation_;
  std::unique_ptr<TileSpectra> previous_;
  std::unique_ptr<TileSpectra> current_;
  std::unique_ptr<TileSpectra> trial_;
  std::vector<Candidate> candidates_;
  std::array<Eigen::Matrix3d, 3> found_;
  bool has_previous_ = false;
  bool has_two_ = false;
};

}  // namespace windhover
