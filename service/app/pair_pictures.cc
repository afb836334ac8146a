// SPDX-License-Identifier: Apache-2.0
#include "service/app/pair_pictures.h"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace windhover {

PairPictures CompareAligned(const cv::Mat& a, const cv::Mat& b, const Eigen::Matrix3d& b_from_a) {
  cv::Matx33d matrix;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix(row, column) = b_from_a(row, column);
  }
  cv::Mat a_in_b, seen;
  cv::warpPerspective(a, a_in_b, matrix, b.size());
  cv::warpPerspective(cv::Mat(a.size(), CV_8U, cv::Scalar(255)), seen, matrix, b.size());
  seen = seen == 255;

  cv::Scalar a_mean, a_deviation, b_mean, b_deviation;
  cv::meanStdDev(a_in_b, a_mean, a_deviation, seen);
  cv::meanStdDev(b, b_mean, b_deviation, seen);
  const double gain = a_deviation[0] > 0.0 ? b_deviation[0] / a_deviation[0] : 1.0;
  cv::Mat matched;
  a_in_b.convertTo(matched, CV_8U, gain, b_mean[0] - gain * a_mean[0]);

  PairPictures pictures;
  cv::absdiff(matched, b, pictures.difference);
  pictures.difference.setTo(0, ~seen);
  cv::Mat red = matched, cyan = b.clone();
  const cv::Mat dark = 0.5 * b;
  dark.copyTo(red, ~seen);
  dark.copyTo(cyan, ~seen);
  cv::merge(std::vector<cv::Mat>{cyan, cyan, red}, pictures.blended);
  return pictures;
}

}  // namespace windhover
