// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/klt_registration.h"

#include <opencv2/video/tracking.hpp>
#include <utility>

namespace windhover::replay {
namespace {

constexpr int kColumns = 16;
constexpr int kRows = 12;
constexpr int kLevels = 3;
constexpr double kRansacPx = 1.0;
const cv::Size kWindow(21, 21);

}  // namespace

std::optional<Eigen::Matrix3d> KltRegistration::Register(const cv::Mat& gray) {
  std::swap(previous_pyramid_, pyramid_);
  cv::buildOpticalFlowPyramid(gray, pyramid_, kWindow, kLevels);
  if (grid_.empty()) {
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        grid_.emplace_back((static_cast<float>(column) + 0.5F) * gray.cols / kColumns,
                           (static_cast<float>(row) + 0.5F) * gray.rows / kRows);
      }
    }
  }
  if (previous_pyramid_.empty()) return std::nullopt;
  cv::calcOpticalFlowPyrLK(pyramid_, previous_pyramid_, grid_, found_, status_, error_, kWindow,
                           kLevels);
  from_.clear();
  to_.clear();
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (status_[i] == 0) continue;
    from_.push_back(grid_[i]);
    to_.push_back(found_[i]);
  }
  return RansacHomography(from_, to_, kRansacPx);
}

void KltRegistration::Reset() {
  previous_pyramid_.clear();
  pyramid_.clear();
}

}  // namespace windhover::replay
