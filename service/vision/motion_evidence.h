// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "gpu-kernels/backend.h"
#include "service/vision/types.h"

namespace windhover {

// What a window of registered frames says about its centre frame: the link between background
// subtraction and motion detection. The grid is the picture of a frame of the window, the centre
// frame in centre mode, with a margin on each side.
struct MotionEvidence {
  // The registered frame R_j and its motion seeds H_j (thesis 6.3), both on the grid.
  struct Sample {
    std::shared_ptr<const GrayImage> registered;
    std::shared_ptr<const BitImage> seeds;
    // Temporal distance from the centre frame: negative before it, 0 for itself.
    int offset_frames = 0;
  };

  FrameRegistration registration;  // of the centre frame
  Eigen::Matrix3d frame_from_grid = Eigen::Matrix3d::Identity();
  int frame_width = 0;
  int frame_height = 0;
  std::vector<Sample> samples;  // in temporal order
  std::size_t centre = 0;       // index of the centre frame in `samples`
  std::shared_ptr<const GrayImage> background;
};

}  // namespace windhover
