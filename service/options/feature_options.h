// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service/options/option.h"

namespace windhover {

enum class FeatureDetector { kSift, kAkaze, kOrb };

// How a homography is found among matches some of which are wrong.
enum class RobustEstimator {
  kRansac,  // the one that most matches agree with to within a given distance
  kLmeds,   // least median of squares; takes the distance from the matches' own scatter
};

// Registration of two pictures by local features (thesis 2.3.1).
struct FeatureRegistrationOptions {
  FeatureDetector detector = FeatureDetector::kSift;
  int max_features = 2000;
  double match_ratio = 0.8;
  RobustEstimator robust = RobustEstimator::kRansac;
  double inlier_distance_px = 3.0;

  static constexpr auto Fields() {
    using O = FeatureRegistrationOptions;
    return std::make_tuple(
        Choice("detector", &O::detector, std::array<std::string_view, 3>{"sift", "akaze", "orb"},
               std::array<std::string_view, 3>{"exact, slow", "less slow, fewer points",
                                               "fast, its points lie less exactly"},
               "What finds and describes points"),
        Number("max-features", &O::max_features, 8, 100000, "",
               "Points taken from each picture, the strongest first"),
        Number("match-ratio", &O::match_ratio, 0.1, 1.0, "",
               "Distance of the nearest descriptor over that of the second nearest from which a "
               "match is ambiguous"),
        Choice("robust", &O::robust, std::array<std::string_view, 2>{"ransac", "lmeds"},
               std::array<std::string_view, 2>{
                   "most matches within inlier-distance",
                   "least median of squares, where more than half of the matches are right"},
               "How a homography is found among wrong matches"),
        Number("inlier-distance", &O::inlier_distance_px, 0.1, 50.0, "px",
               "Largest distance from the homography at which a match is an inlier; with lmeds "
               "an upper limit"));
  }
};

}  // namespace windhover
