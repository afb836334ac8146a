// SPDX-License-Identifier: Apache-2.0
#include "service/vision/photometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace windhover {
namespace {

constexpr int kLevels = 256;
constexpr double kWhite = 255.0;

float Clipped(double value) { return static_cast<float>(std::clamp(value, 0.0, kWhite)); }

// A function that is linear between knots of strictly rising x, and constant beyond them.
class LinearSegments {
 public:
  void Add(double x, double y) {
    x_[count_] = x;
    y_[count_++] = y;
  }
  double operator()(double x) const {
    const double* const end = x_.data() + count_;
    const auto after = std::upper_bound(x_.data(), end, x) - x_.data();
    if (after == 0) return y_[0];
    if (after == count_) return y_[count_ - 1];
    const double share = (x - x_[after - 1]) / (x_[after] - x_[after - 1]);
    return y_[after - 1] + share * (y_[after] - y_[after - 1]);
  }
  int count() const { return count_; }
  double first_x() const { return x_[0]; }
  double last_x() const { return x_[count_ - 1]; }

 private:
  std::array<double, kLevels> x_{};
  std::array<double, kLevels> y_{};
  int count_ = 0;
};

// For each grey value that occurs, calls visit(value, rank): the share of pixels below the middle
// of those that have it, between 0 and 1.
template <typename Visit>
void ForEachRank(const GreyHistogram& histogram, Visit visit) {
  const double total = std::accumulate(histogram.begin(), histogram.end(), 0.0);
  double below = 0.0;
  for (int value = 0; value < kLevels; ++value) {
    const double count = histogram[value];
    if (count > 0.0) visit(value, (below + 0.5 * count) / total);
    below += count;
  }
}

}  // namespace

GainBias Inverse(const GainBias& reference_from_frame) {
  return {1.0 / reference_from_frame.gain, -reference_from_frame.bias / reference_from_frame.gain};
}

IntensityMap ToIntensityMap(const GainBias& reference_from_frame) {
  IntensityMap map;
  for (int value = 0; value < kLevels; ++value) map[value] = Clipped(reference_from_frame(value));
  return map;
}

IntensityMap ResponseMap(std::span<const double, 256> log_exposure, double exposure_ratio) {
  if (!(exposure_ratio > 0.0) || !std::isfinite(exposure_ratio)) {
    throw std::invalid_argument("exposure ratio " + std::to_string(exposure_ratio) +
                                " is not positive and finite");
  }
  LinearSegments value_of_log_exposure;
  for (int value = 0; value < kLevels; ++value) {
    const bool rises = value == 0 || log_exposure[value] > log_exposure[value - 1];
    if (!rises || !std::isfinite(log_exposure[value])) {
      throw std::invalid_argument("the response curve does not rise at grey value " +
                                  std::to_string(value));
    }
    value_of_log_exposure.Add(log_exposure[value], value);
  }
  IntensityMap map;
  for (int value = 0; value < kLevels; ++value) {
    map[value] = Clipped(value_of_log_exposure(log_exposure[value] + std::log(exposure_ratio)));
  }
  return map;
}

GreyHistogram HistogramOf(const GrayImage& picture, const GrayImage* mask) {
  if (mask != nullptr && (mask->width() != picture.width() || mask->height() != picture.height())) {
    throw std::invalid_argument("a picture and its mask differ in size");
  }
  GreyHistogram histogram{};
  const auto pixels = picture.Read();
  if (mask == nullptr) {
    for (int y = 0; y < pixels.height(); ++y) {
      for (int x = 0; x < pixels.width(); ++x) ++histogram[pixels.at(x, y)];
    }
    return histogram;
  }
  const auto use = mask->Read();
  for (int y = 0; y < pixels.height(); ++y) {
    for (int x = 0; x < pixels.width(); ++x) {
      if (use.at(x, y) != 0) ++histogram[pixels.at(x, y)];
    }
  }
  return histogram;
}

std::optional<IntensityMap> HistogramMap(const GreyHistogram& reference,
                                         const GreyHistogram& frame) {
  LinearSegments reference_of_rank;
  ForEachRank(reference, [&](int value, double rank) { reference_of_rank.Add(rank, value); });
  if (reference_of_rank.count() == 0) return std::nullopt;
  LinearSegments reference_of_frame;
  ForEachRank(frame, [&](int value, double rank) {
    reference_of_frame.Add(value, reference_of_rank(rank));
  });
  if (reference_of_frame.count() == 0) return std::nullopt;
  IntensityMap map;
  for (int value = 0; value < kLevels; ++value) {
    const double below = std::min(0.0, value - reference_of_frame.first_x());
    const double above = std::max(0.0, value - reference_of_frame.last_x());
    map[value] = Clipped(reference_of_frame(value) + below + above);
  }
  return map;
}

}  // namespace windhover
