// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/luma.h"

#include <cstring>
#include <opencv2/imgproc.hpp>

namespace windhover::replay {

void CopyGray(const cv::Mat& picture, GrayImage& gray) {
  const MappedImage<std::uint8_t> pixels = gray.Write();
  for (int y = 0; y < picture.rows; ++y) {
    std::memcpy(pixels.row(y), picture.ptr(y), static_cast<std::size_t>(picture.cols));
  }
}

void CopyLuma(const cv::Mat& frame, cv::Mat& luma, GrayImage& gray) {
  cv::cvtColor(frame, luma, cv::COLOR_BGR2GRAY);
  CopyGray(luma, gray);
}

}  // namespace windhover::replay
