// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "gpu-kernels/image.h"
#include "service/options/feature_options.h"

namespace windhover {

// The local features of one picture, strongest first. A value: copies share the descriptors, which
// nobody changes.
struct PictureFeatures {
  int width = 0;  // of the picture, px
  int height = 0;
  std::vector<Eigen::Vector2d> x_in_picture;  // px, pixel centres at integers
  std::vector<double> sigma_px;               // standard deviation expected of each coordinate
  // A row for each: floats to be compared by Euclidean distance, or bytes by Hamming distance.
  cv::Mat descriptors;

  int size() const { return static_cast<int>(x_in_picture.size()); }
};

// Detects and describes up to max_features points, only those where `mask`, if there is one, is not
// 0. The same picture gives the same features, in the same order. Pictures too small to hold a
// feature have none. Throws std::invalid_argument for a mask of another size than the picture.
PictureFeatures DetectFeatures(const GrayImage& picture, const GrayImage* mask,
                               const FeatureRegistrationOptions& options);

}  // namespace windhover
