// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

namespace windhover::replay {

// Writes a grey picture, making its folder.
inline void WritePicture(const std::filesystem::path& file, int width = 64, int height = 48,
                         int level = 128) {
  std::filesystem::create_directories(file.parent_path());
  if (!cv::imwrite(file.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar::all(level)))) {
    throw std::runtime_error("cannot write " + file.string());
  }
}

// `count` pictures PREFIX + number + ENDING, the number having so many digits.
inline void WritePictures(const std::filesystem::path& folder, const std::string& prefix,
                          int digits, const std::string& ending, int count, int first = 1) {
  for (int i = first; i < first + count; ++i) {
    const std::string number = std::to_string(i);
    WritePicture(folder / (prefix + std::string(digits - number.size(), '0') + number + ending));
  }
}

}  // namespace windhover::replay
