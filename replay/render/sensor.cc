// SPDX-License-Identifier: Apache-2.0
#include "replay/render/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "replay/render/portable_math.h"

namespace windhover::replay {
namespace {

// e^-x for x >= 0 by halving the argument and a series: the same on every machine.
double Decay(double x) {
  const double h = -x / 64;
  double value = 1 + h * (1 + h / 2 * (1 + h / 3 * (1 + h / 4 * (1 + h / 5))));
  for (int i = 0; i < 6; ++i) value *= value;
  return value;
}

}  // namespace

Sensor::Sensor(const SensorPlan& plan, std::uint64_t seed) : plan_(plan), seed_(seed) {
  kernel_ = {1.0F};
  if (plan.psf_sigma_px <= 0) return;
  const int radius = std::max(1, static_cast<int>(3 * plan.psf_sigma_px + 0.5));
  double sum = 1;
  for (int i = 1; i <= radius; ++i) {
    kernel_.push_back(
        static_cast<float>(Decay(i * i / (2 * plan.psf_sigma_px * plan.psf_sigma_px))));
    sum += 2 * kernel_.back();
  }
  for (float& weight : kernel_) weight /= static_cast<float>(sum);
}

// Separable; the picture goes on past its border as its last row or column.
void Sensor::Spread(cv::Mat& light) const {
  const int radius = static_cast<int>(kernel_.size()) - 1;
  if (radius == 0) return;
  cv::Mat across(light.size(), CV_32FC3);
  for (int y = 0; y < light.rows; ++y) {
    const auto* in = light.ptr<float>(y);
    auto* out = across.ptr<float>(y);
    for (int x = 0; x < light.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        float sum = kernel_[0] * in[3 * x + c];
        for (int i = 1; i <= radius; ++i) {
          sum += kernel_[i] *
                 (in[3 * std::max(0, x - i) + c] + in[3 * std::min(light.cols - 1, x + i) + c]);
        }
        out[3 * x + c] = sum;
      }
    }
  }
  for (int y = 0; y < light.rows; ++y) {
    auto* out = light.ptr<float>(y);
    const auto* centre = across.ptr<float>(y);
    for (int x = 0; x < 3 * light.cols; ++x) out[x] = kernel_[0] * centre[x];
    for (int i = 1; i <= radius; ++i) {
      const auto* up = across.ptr<float>(std::max(0, y - i));
      const auto* down = across.ptr<float>(std::min(light.rows - 1, y + i));
      for (int x = 0; x < 3 * light.cols; ++x) out[x] += kernel_[i] * (up[x] + down[x]);
    }
  }
}

Sensor::Exposure Sensor::ExposureAt(double frame) const {
  Exposure exposure = {plan_.gain, plan_.bias};
  for (const ExposureStep& step : plan_.steps) {
    const double share = std::clamp((frame - step.frame) / step.over, 0.0, 1.0);
    exposure.gain += share * (step.gain - exposure.gain);
    exposure.bias += share * (step.bias - exposure.bias);
  }
  return exposure;
}

std::vector<float> Sensor::ColumnLevels(int width) const {
  std::vector<float> levels(width);
  for (int x = 0; x < width; ++x) {
    levels[x] = static_cast<float>(plan_.column_sigma) *
                NormalFromBits(Mix(seed_, 0xC0103A + static_cast<std::uint64_t>(x)));
  }
  return levels;
}

cv::Mat Sensor::Expose(cv::Mat& light, int frame) const {
  Spread(light);
  // The standard deviation of the noise that the colours share, at each whole grey level.
  std::array<float, 256> sigma{};
  for (int value = 0; value < 256; ++value) {
    sigma[value] = static_cast<float>(
        std::sqrt(plan_.read_sigma * plan_.read_sigma + plan_.shot_gain * value));
  }
  const Exposure exposure = ExposureAt(frame);
  const auto bias = static_cast<float>(exposure.bias);
  const auto chroma = static_cast<float>(plan_.chroma_sigma);
  const std::vector<float> columns = ColumnLevels(light.cols);
  const double half_diagonal2 = 0.25 * (light.cols * light.cols + light.rows * light.rows);
  const std::uint64_t key = Mix(seed_, 0x5E9502 + static_cast<std::uint64_t>(frame));
  cv::Mat picture(light.size(), CV_8UC3);
  for (int y = 0; y < light.rows; ++y) {
    const auto* in = light.ptr<float>(y);
    auto* out = picture.ptr<std::uint8_t>(y);
    const double dy = y - 0.5 * (light.rows - 1);
    for (int x = 0; x < light.cols; ++x) {
      const double dx = x - 0.5 * (light.cols - 1);
      const auto gain = static_cast<float>(
          exposure.gain * (1 - plan_.vignetting * (dx * dx + dy * dy) / half_diagonal2));
      std::array<float, 3> value{};
      for (int c = 0; c < 3; ++c) value[c] = gain * in[3 * x + c] + bias + columns[x];
      if (plan_.grey) value.fill(0.114F * value[0] + 0.587F * value[1] + 0.299F * value[2]);
      std::uint64_t bits = Mix(key + (static_cast<std::uint64_t>(y) << 32) + x);
      const auto level = static_cast<int>(std::clamp(value[1], 0.0F, 255.0F));
      const float shared = sigma[level] * NormalFromBits(bits);
      for (int c = 0; c < 3; ++c) {
        float noise = shared;
        if (!plan_.grey) {
          bits = Mix(bits);
          noise += chroma * NormalFromBits(bits);
        }
        out[3 * x + c] =
            static_cast<std::uint8_t>(std::clamp(value[c] + noise, 0.0F, 255.0F) + 0.5F);
      }
    }
  }
  return picture;
}

}  // namespace windhover::replay
