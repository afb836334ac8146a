// SPDX-License-Identifier: Apache-2.0
#include "service/app/picture_file.h"

#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <vector>

#include "service/vision/gray_range.h"

namespace windhover {
namespace {

cv::Mat Read(const std::string& path) {
  try {
    return cv::imread(path, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(path + ": cannot be read: " + error.err);
  }
}

cv::Mat InItsRange(const cv::Mat& picture) {
  GrayHistogram histogram;
  for (int y = 0; y < picture.rows; ++y) {
    const auto* row = picture.ptr<std::uint16_t>(y);
    for (int x = 0; x < picture.cols; ++x) histogram.Add(row[x]);
  }
  const auto table = std::make_unique<GrayTable>();
  FillTable(histogram.RobustRange(), *table);
  cv::Mat gray(picture.size(), CV_8U);
  for (int y = 0; y < picture.rows; ++y) {
    const auto* row = picture.ptr<std::uint16_t>(y);
    for (int x = 0; x < picture.cols; ++x) gray.at<std::uint8_t>(y, x) = (*table)[row[x]];
  }
  return gray;
}

}  // namespace

cv::Mat ReadGrayPicture(const std::string& path) {
  if (!std::filesystem::exists(path)) throw std::runtime_error(path + ": there is no such file");
  const cv::Mat picture = Read(path);
  if (picture.empty()) throw std::runtime_error(path + ": not a picture that can be read");
  if (picture.depth() == CV_8U) return picture;
  if (picture.depth() == CV_16U) return InItsRange(picture);
  throw std::runtime_error(path + ": neither 8 nor 16 bits a pixel");
}

void WritePng(const std::filesystem::path& path, const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace windhover
