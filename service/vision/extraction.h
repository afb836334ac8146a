// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "service/vision/motion_window.h"
#include "service/vision/types.h"

namespace windhover {

// Seeds that belong to one thing: its component and what it covers.
struct SeedComponent {
  int area_px = 0;  // seeds
  Box box;          // of the seeds, in frame coordinates
  // The same on the grid: pixels left <= x <= right, top <= y <= bottom.
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  // Index of the component's first piece in SeedExtraction::pieces(), and how many there are.
  int first_piece = 0;
  int piece_count = 0;
};

// Morphology and connected components (thesis 6.3): erosion with a square of side
// 2 * erosion + 1 removes the smallest hypotheses, dilation with a square of side 2 * dilation + 1
// closes the gaps inside an object, and what then hangs together (8-neighbourhood) is one
// component. Its area and box are those of the given seeds that it covers, so that neither
// morphology nor a turned grid inflates the box. Outside the grid there are no seeds.
class SeedExtraction {
 public:
  // Radii in px, 0 or more; components of less than `min_area_px` seeds are dropped.
  SeedExtraction(int erosion_px, int dilation_px, int min_area_px);

  void set_dilation(int radius_px) { dilation_px_ = radius_px; }

  // Components in scan order of their first pixel. `frame_from_grid` takes pixels of the grid to
  // the frame whose coordinates the boxes are in.
  const std::vector<SeedComponent>& Run(const BitView& seeds,
                                        const Eigen::Matrix3d& frame_from_grid);

  // Runs of seeds, those of one component next to each other, in scan order. As of the last Run.
  const std::vector<BitRun>& pieces() const { return pieces_; }

 private:
  void Erode(const BitView& seeds);
  void Dilate();
  void LabelRuns();
  int Root(int run);
  void GatherPieces(const BitView& seeds);
  Box FrameBox(const SeedComponent& component, const Eigen::Matrix3d& frame_from_grid) const;

  int erosion_px_;
  int dilation_px_;
  int min_area_px_;
  BitPlane plane_;
  BitPlane scratch_;
  BitRuns grown_;   // runs of the dilated map
  BitRuns sparse_;  // runs of the seeds
  std::vector<int> parent_;
  std::vector<int> component_of_;  // of each run of grown_
  std::vector<int> grown_of_;      // of each run of sparse_, or -1
  std::vector<BitRun> pieces_;
  std::vector<SeedComponent> components_;
};

}  // namespace windhover
