// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "service/vision/homography.h"
#include "service/vision/picture_features.h"

namespace windhover {

// A feature of the reference and one of the frame, by index, that look alike.
struct FeatureMatch {
  int reference = 0;
  int frame = 0;
  double distance = 0.0;  // of their descriptors
};

// For each feature of the reference the frame's nearest by descriptor, where it is nearer than
// `ratio` times the second nearest (D. Lowe, 2004, section 7.1; thesis 2.3.1). No feature of the
// frame is matched twice, and no pair of places. Throws std::invalid_argument where the two were
// described by different detectors.
std::vector<FeatureMatch> MatchByRatio(const PictureFeatures& reference,
                                       const PictureFeatures& frame, double ratio);

// The same among those of the frame's features that lie within `radius_px` of where the homography
// puts the reference's, if their descriptors are no further apart than `max_distance` (thesis
// algorithm 1, step 5): finds what the ratio test over the whole frame held for ambiguous.
std::vector<FeatureMatch> MatchGuided(const PictureFeatures& reference,
                                      const PictureFeatures& frame,
                                      const Eigen::Matrix3d& frame_from_reference, double radius_px,
                                      double ratio, double max_distance);

}  // namespace windhover
