// SPDX-License-Identifier: Apache-2.0
#include "replay/render/ground_photo.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace windhover::replay {
namespace {

cv::Mat Halved(const cv::Mat& picture) {
  cv::Mat half(picture.rows / 2, picture.cols / 2, CV_8UC3);
  for (int y = 0; y < half.rows; ++y) {
    const auto* top = picture.ptr<std::uint8_t>(2 * y);
    const auto* bottom = picture.ptr<std::uint8_t>(2 * y + 1);
    auto* out = half.ptr<std::uint8_t>(y);
    for (int x = 0; x < half.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        const int sum =
            top[6 * x + c] + top[6 * x + 3 + c] + bottom[6 * x + c] + bottom[6 * x + 3 + c];
        out[3 * x + c] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return half;
}

int Mirrored(int i, int size) {
  const int period = 2 * size;
  const int place = ((i % period) + period) % period;
  return place < size ? place : period - 1 - place;
}

}  // namespace

GroundPhoto::GroundPhoto(const cv::Mat& picture, double pixel_m) : pixel_m_(pixel_m) {
  if (picture.type() != CV_8UC3 || picture.rows < 2 || picture.cols < 2 || !(pixel_m > 0)) {
    throw std::invalid_argument("a ground picture needs 2x2 px in colour and a size on the map");
  }
  levels_.push_back(picture);
  while (std::min(levels_.back().rows, levels_.back().cols) >= 8) {
    levels_.push_back(Halved(levels_.back()));
  }
}

Colour GroundPhoto::At(double x, double y, double texel_m) const {
  std::size_t level = 0;
  double pixel = pixel_m_;
  while (level + 1 < levels_.size() && pixel * 1.5 < texel_m) {
    pixel *= 2;
    ++level;
  }
  const cv::Mat& picture = levels_[level];
  const double u = x / pixel + 0.5 * picture.cols - 0.5;
  const double v = y / pixel + 0.5 * picture.rows - 0.5;
  const int column = static_cast<int>(std::floor(u));
  const int row = static_cast<int>(std::floor(v));
  const auto share_x = static_cast<float>(u - column);
  const auto share_y = static_cast<float>(v - row);
  const auto at = [&picture](int i, int j) {
    return picture.ptr<std::uint8_t>(Mirrored(j, picture.rows)) + 3 * Mirrored(i, picture.cols);
  };
  const std::uint8_t* a = at(column, row);
  const std::uint8_t* b = at(column + 1, row);
  const std::uint8_t* c = at(column, row + 1);
  const std::uint8_t* d = at(column + 1, row + 1);
  Colour colour{};
  for (int i = 0; i < 3; ++i) {
    const float top = static_cast<float>(a[i]) * (1 - share_x) + static_cast<float>(b[i]) * share_x;
    const float low = static_cast<float>(c[i]) * (1 - share_x) + static_cast<float>(d[i]) * share_x;
    colour[i] = top * (1 - share_y) + low * share_y;
  }
  return colour;
}

}  // namespace windhover::replay
