// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/matx.hpp>

namespace windhover::replay {

inline cv::Matx33d ToOpenCv(const Eigen::Matrix3d& matrix) {
  cv::Matx33d copy;
  for (int i = 0; i < 9; ++i) copy(i / 3, i % 3) = matrix(i / 3, i % 3);
  return copy;
}

}  // namespace windhover::replay
