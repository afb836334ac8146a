// SPDX-License-Identifier: Apache-2.0
#include "service/vision/gain_bias_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace windhover {
namespace {

constexpr int kLevels = 256;

// How many pixels show `frame` in the frame and `reference` in the reference: one entry of what the
// thesis, 4.2.1, calls a comparagram.
struct PairCount {
  double frame;
  double reference;
  double pixels;
};

bool SameSize(const GrayImage& a, const GrayImage& b) {
  return a.width() == b.width() && a.height() == b.height();
}

std::vector<PairCount> CountPairs(const GrayImage& reference, const GrayImage& frame,
                                  const GrayImage* mask) {
  std::vector<std::uint32_t> counts(kLevels * kLevels, 0);
  const auto in_reference = reference.Read();
  const auto in_frame = frame.Read();
  std::optional<MappedImage<const std::uint8_t>> use;
  if (mask != nullptr) use.emplace(mask->Read());
  for (int y = 0; y < in_frame.height(); ++y) {
    for (int x = 0; x < in_frame.width(); ++x) {
      if (use && use->at(x, y) == 0) continue;
      ++counts[in_frame.at(x, y) * kLevels + in_reference.at(x, y)];
    }
  }
  std::vector<PairCount> pairs;
  for (int a = 1; a < kLevels - 1; ++a) {
    for (int b = 1; b < kLevels - 1; ++b) {
      const std::uint32_t pixels = counts[a * kLevels + b];
      if (pixels > 0) {
        pairs.push_back({static_cast<double>(a), static_cast<double>(b), 1.0 * pixels});
      }
    }
  }
  return pairs;
}

double Distance(const GainBias& line, const PairCount& pair) {
  return (pair.reference - line(pair.frame)) / std::hypot(1.0, line.gain);
}

struct FittedLine {
  GainBias line;
  // Variances of the pixels along the line and across it.
  double along = 0.0;
  double across = 0.0;
};

// The line of the least sum of squared orthogonal distances, each pair weighted by its pixels and
// by weight(pair). Nothing where it does not rise.
template <typename Weight>
std::optional<FittedLine> OrthogonalFit(const std::vector<PairCount>& pairs, Weight weight) {
  double sum = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0, sum_yy = 0.0;
  for (const PairCount& pair : pairs) {
    const double w = pair.pixels * weight(pair);
    sum += w;
    sum_x += w * pair.frame;
    sum_y += w * pair.reference;
    sum_xx += w * pair.frame * pair.frame;
    sum_xy += w * pair.frame * pair.reference;
    sum_yy += w * pair.reference * pair.reference;
  }
  if (!(sum > 0.0)) return std::nullopt;
  const double mean_x = sum_x / sum;
  const double mean_y = sum_y / sum;
  const double xx = sum_xx / sum - mean_x * mean_x;
  const double xy = sum_xy / sum - mean_x * mean_y;
  const double yy = sum_yy / sum - mean_y * mean_y;
  if (xy <= 0.0) return std::nullopt;
  const double spread = std::hypot(yy - xx, 2.0 * xy);
  const double gain = (yy - xx + spread) / (2.0 * xy);
  return FittedLine{
      {gain, mean_y - gain * mean_x}, 0.5 * (xx + yy + spread), 0.5 * (xx + yy - spread)};
}

bool StandsOutOfNoise(const FittedLine& fit) {
  constexpr double kLeastVariance = 1.0;
  constexpr double kLeastElongation = 4.0;
  return fit.along >= kLeastVariance && fit.along >= kLeastElongation * fit.across;
}

// Median of the absolute distance from the line, to a sixteenth of a grey level.
double MedianDistance(const std::vector<PairCount>& pairs, const GainBias& line) {
  constexpr double kBinsPerLevel = 16.0;
  std::array<double, 6000> bins{};
  double total = 0.0;
  for (const PairCount& pair : pairs) {
    const auto bin = static_cast<std::size_t>(kBinsPerLevel * std::abs(Distance(line, pair)));
    bins[std::min(bin, bins.size() - 1)] += pair.pixels;
    total += pair.pixels;
  }
  double below = 0.0;
  std::size_t bin = 0;
  while (bin + 1 < bins.size() && below + bins[bin] < 0.5 * total) below += bins[bin++];
  return (static_cast<double>(bin) + 0.5) / kBinsPerLevel;
}

GainBiasFit Judge(const std::vector<PairCount>& pairs, const GainBias& line) {
  constexpr double kMedianPerSigma = 0.6745;
  constexpr double kAgreeing = 3.0;
  const double limit = kAgreeing * std::max(MedianDistance(pairs, line) / kMedianPerSigma, 0.5);
  double squared = 0.0, agreeing = 0.0, total = 0.0;
  for (const PairCount& pair : pairs) {
    total += pair.pixels;
    const double distance = Distance(line, pair);
    if (std::abs(distance) > limit) continue;
    agreeing += pair.pixels;
    squared += pair.pixels * distance * distance;
  }
  return {line, std::sqrt(squared / std::max(agreeing, 1.0)), agreeing / total};
}

}  // namespace

std::optional<GainBiasFit> FitGainBias(const GrayImage& reference, const GrayImage& frame,
                                       const GrayImage* mask) {
  if (!SameSize(reference, frame) || (mask != nullptr && !SameSize(reference, *mask))) {
    throw std::invalid_argument("pictures to compare, or their mask, differ in size");
  }
  const std::vector<PairCount> pairs = CountPairs(reference, frame, mask);
  constexpr double kLeastPixels = 64.0;
  double pixels = 0.0;
  for (const PairCount& pair : pairs) pixels += pair.pixels;
  if (pixels < kLeastPixels) return std::nullopt;

  constexpr double kFirstScale = 64.0;  // grey levels
  constexpr double kFall = 0.7;
  constexpr double kScalePerMedian = 3.0;
  constexpr int kMostSteps = 30;
  // The first line goes through all pixels with a weight that hardly tells them apart.
  FittedLine fit;
  double scale = 8.0 * kFirstScale;
  for (int step = 0; step < kMostSteps; ++step) {
    const double s2 = scale * scale;
    const std::optional<FittedLine> next = OrthogonalFit(pairs, [&](const PairCount& pair) {
      const double r = Distance(fit.line, pair);
      const double w = s2 / (s2 + r * r);
      return w * w;
    });
    if (!next) return std::nullopt;
    const double floor = std::max(1.0, kScalePerMedian * MedianDistance(pairs, next->line));
    const bool settled = scale <= floor && std::abs(next->line.gain - fit.line.gain) < 1e-6 &&
                         std::abs(next->line.bias - fit.line.bias) < 1e-4;
    fit = *next;
    if (settled) break;
    scale = std::max(std::min(kFall * scale, kFirstScale), floor);
  }
  if (!StandsOutOfNoise(fit)) return std::nullopt;
  return Judge(pairs, fit.line);
}

}  // namespace windhover
