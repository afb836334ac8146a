// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/phase_correlation/phase_correlation_tables.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace windhover {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDamping = 64.0;
constexpr float kMinHeight = 1e-4F;
constexpr int kMinSide = 16;
constexpr int kMaxSide = 512;
constexpr int kMaxTiles = 1024;

bool IsTileSide(int side) {
  return side >= kMinSide && side <= kMaxSide && std::has_single_bit(static_cast<unsigned>(side));
}

bool IsWindowAlpha(TileWindow window, float alpha) {
  switch (window) {
    case TileWindow::kNone:
    case TileWindow::kCosine:
      return true;
    case TileWindow::kBlackman:
      return alpha >= 0.0F && alpha <= 0.25F;
    case TileWindow::kGaussian:
      return alpha > 0.0F && alpha <= 10.0F;
    case TileWindow::kTukey:
      return alpha >= 0.0F && alpha <= 1.0F;
  }
  return false;
}

void Check(const PhaseCorrelationSettings& settings) {
  if (!IsTileSide(settings.tile_width) || !IsTileSide(settings.tile_height)) {
    throw std::invalid_argument("phase correlation: tile sides must be powers of two, 16 to 512");
  }
  if (settings.tiles.empty() || settings.tiles.size() > kMaxTiles) {
    throw std::invalid_argument("phase correlation: must have 1 to 1024 tiles");
  }
  if (!IsWindowAlpha(settings.window, settings.window_alpha)) {
    throw std::invalid_argument("phase correlation: alpha out of its window's range");
  }
  if (!(settings.peak_sigma_px >= 0.0F && settings.peak_sigma_px <= 4.0F)) {
    throw std::invalid_argument("phase correlation: peak sigma must be 0 to 4 px");
  }
  if (!(settings.noise_sigma > 0.0F && settings.noise_sigma <= 255.0F)) {
    throw std::invalid_argument("phase correlation: noise sigma must be over 0 and at most 255");
  }
}

// Weight at `x` in (0, 1), from one border of the tile to the other.
double WindowWeight(TileWindow window, double alpha, double x) {
  const double phase = 2.0 * kPi * x;
  switch (window) {
    case TileWindow::kNone:
      return 1.0;
    case TileWindow::kBlackman:
      return (1.0 - alpha) / 2.0 - 0.5 * std::cos(phase) + alpha / 2.0 * std::cos(2.0 * phase);
    case TileWindow::kCosine:
      return std::sin(0.5 * phase);
    case TileWindow::kGaussian:
      return std::exp(-0.5 * (x - 0.5) * (x - 0.5) / (alpha * alpha));
    case TileWindow::kTukey: {
      const double taper = 0.5 * (1.0 - alpha);
      const double from_border = std::min(x, 1.0 - x);
      return from_border >= taper ? 1.0 : 0.5 - 0.5 * std::cos(kPi * from_border / taper);
    }
  }
  return 1.0;
}

// At the middles of `side` equal parts of its support.
std::vector<float> WindowWeights(const PhaseCorrelationSettings& settings, int side) {
  std::vector<float> weights(side);
  for (int i = 0; i < side; ++i) {
    const double x = (i + 0.5) / side;
    weights[i] = static_cast<float>(WindowWeight(settings.window, settings.window_alpha, x));
  }
  return weights;
}

// Frequency of a transform's bin in cycles a px, -1/2 to 1/2.
double Frequency(int bin, int side) {
  return static_cast<double>(bin <= side / 2 ? bin : bin - side) / side;
}

std::vector<float> SpectralWeight(int width, int height, double sigma) {
  const auto gaussian = [sigma](double fx, double fy) {
    return std::exp(-2.0 * kPi * kPi * sigma * sigma * (fx * fx + fy * fy));
  };
  double sum = -1.0;  // all bins but the zero frequency
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) sum += gaussian(Frequency(x, width), Frequency(y, height));
  }
  std::vector<float> weights;
  weights.reserve((width / 2 + 1) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x <= width / 2; ++x) {
      const double weight = gaussian(Frequency(x, width), Frequency(y, height)) / sum;
      weights.push_back(static_cast<float>(weight));
    }
  }
  weights[0] = 0.0F;
  return weights;
}

double Sum(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += value;
  return sum;
}

double SumOfSquares(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return sum;
}

// Where between its neighbours a sampled maximum lies, -0.5 to 0.5.
float SubPixelOffset(float left, float centre, float right) {
  if (left > 0.0F && centre > 0.0F && right > 0.0F) {
    left = std::log(left);
    centre = std::log(centre);
    right = std::log(right);
  }
  const float denominator = 4.0F * centre - 2.0F * left - 2.0F * right;
  if (!(denominator > 0.0F)) return 0.0F;
  return std::clamp((right - left) / denominator, -0.5F, 0.5F);
}

struct Offset {
  float x;
  float y;
};

// Normal equations in six unknowns with their right side in the last column, solved by elimination.
// They must be positive definite.
std::array<double, 6> Solve(std::array<std::array<double, 7>, 6>& n) {
  for (int k = 0; k < 6; ++k) {
    for (int row = k + 1; row < 6; ++row) {
      const double factor = n[row][k] / n[k][k];
      for (int column = k; column < 7; ++column) n[row][column] -= factor * n[k][column];
    }
  }
  std::array<double, 6> solution{};
  for (int k = 5; k >= 0; --k) {
    double rest = n[k][6];
    for (int column = k + 1; column < 6; ++column) rest -= n[k][column] * solution[column];
    solution[k] = rest / n[k][k];
  }
  return solution;
}

// Where about the highest sample the peak lies: the maximum of the quadratic that fits the
// logarithms of the 3x3 samples about it and of all others above 0.7 of its height, weighted with
// the squared sample, as the noise of a logarithm is that of the sample over the sample (Guo 2011,
// "A simple algorithm for fitting a Gaussian function"). With its mixed term it is exact for a
// Gaussian of any direction; eq. 2.19, a parabola along each axis, misplaces the long slanting
// peaks of motion-blurred pictures by up to a pixel. That remains for peaks on which no such fit
// stands.
Offset SubPixelPeak(std::span<const float> samples, int radius) {
  const int side = 2 * radius + 1;
  const int middle = radius * side + radius;
  const Offset by_axis = {
      SubPixelOffset(samples[middle - 1], samples[middle], samples[middle + 1]),
      SubPixelOffset(samples[middle - side], samples[middle], samples[middle + side])};
  const float least = 0.7F * samples[middle];
  std::array<std::array<double, 7>, 6> normal{};
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      const float sample = samples[middle + y * side + x];
      const bool beside = std::max(std::abs(x), std::abs(y)) <= 1;
      if (beside && !(sample > 0.0F)) return by_axis;
      if (!beside && !(sample > least)) continue;
      const double weight = static_cast<double>(sample) * sample;
      const std::array<double, 7> terms = {1.0,
                                           static_cast<double>(x),
                                           static_cast<double>(y),
                                           0.5 * x * x,
                                           static_cast<double>(x) * y,
                                           0.5 * y * y,
                                           std::log(static_cast<double>(sample))};
      for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 7; ++column) {
          normal[row][column] += weight * terms[row] * terms[column];
        }
      }
    }
  }
  const auto [constant, gx, gy, xx, xy, yy] = Solve(normal);
  const double determinant = xx * yy - xy * xy;
  constexpr double kLeastDeterminant = 0.01;  // of that of a peak along the axes
  if (!(xx < 0.0 && determinant > kLeastDeterminant * xx * yy)) return by_axis;
  const Offset offset = {static_cast<float>((xy * gy - yy * gx) / determinant),
                         static_cast<float>((xy * gx - xx * gy) / determinant)};
  // On a slanting ridge the highest sample may lie some way along it from the maximum.
  constexpr float kFurthest = 1.0F;
  if (!(std::abs(offset.x) <= kFurthest && std::abs(offset.y) <= kFurthest)) return by_axis;
  return offset;
}

struct Moments {
  float xx;
  float xy;
  float yy;
};

Moments FootprintMoments(std::span<const float> samples, int radius, float threshold) {
  const int side = 2 * radius + 1;
  double sum = 0.0, x_sum = 0.0, y_sum = 0.0, xx_sum = 0.0, xy_sum = 0.0, yy_sum = 0.0;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      const double weight = samples[(y + radius) * side + x + radius] - threshold;
      if (!(weight > 0.0)) continue;
      sum += weight;
      x_sum += weight * x;
      y_sum += weight * y;
      xx_sum += weight * x * x;
      xy_sum += weight * x * y;
      yy_sum += weight * y * y;
    }
  }
  constexpr float kSampleExtent = 1.0F / 12.0F;
  if (!(sum > 0.0)) return {kSampleExtent, 0.0F, kSampleExtent};
  const double x_mean = x_sum / sum;
  const double y_mean = y_sum / sum;
  return {static_cast<float>(xx_sum / sum - x_mean * x_mean) + kSampleExtent,
          static_cast<float>(xy_sum / sum - x_mean * y_mean),
          static_cast<float>(yy_sum / sum - y_mean * y_mean) + kSampleExtent};
}

}  // namespace

PhaseCorrelationTables::PhaseCorrelationTables(const PhaseCorrelationSettings& settings) {
  Check(settings);
  tile_width = settings.tile_width;
  tile_height = settings.tile_height;
  spectrum_width = tile_width / 2 + 1;
  window_x = WindowWeights(settings, tile_width);
  window_y = WindowWeights(settings, tile_height);
  window_sum = static_cast<float>(Sum(window_x) * Sum(window_y));
  spectral_weight = SpectralWeight(tile_width, tile_height, settings.peak_sigma_px);
  const double grey_variance =
      static_cast<double>(settings.noise_sigma) * settings.noise_sigma + 1.0 / 12.0;
  damping = static_cast<float>(kDamping * grey_variance * SumOfSquares(window_x) *
                               SumOfSquares(window_y));
  min_height = kMinHeight / std::max(1.0F, settings.noise_sigma * settings.noise_sigma);
  peak_radius = std::min(2 + static_cast<int>(std::ceil(3.0F * settings.peak_sigma_px)),
                         std::min(tile_width, tile_height) / 4);
}

TileSampling SampleTileAt(const Matrix3& picture_from_grid, const TileOrigin& origin,
                          int tile_width, int tile_height) {
  Matrix3 m = WithOrigin(picture_from_grid, origin.x, origin.y);
  const double x = tile_width / 2;
  const double y = tile_height / 2;
  const double w = m[6] * x + m[7] * y + m[8];
  const double u = (m[0] * x + m[1] * y + m[2]) / w;
  const double v = (m[3] * x + m[4] * y + m[5]) / w;
  const double right = std::round(u) - u;
  const double down = std::round(v) - v;
  // The derivative of (u, v) by (x, y), which takes that step back to the tile.
  const double a = (m[0] - u * m[6]) / w, b = (m[1] - u * m[7]) / w;
  const double c = (m[3] - v * m[6]) / w, d = (m[4] - v * m[7]) / w;
  const double determinant = a * d - b * c;
  const double dx = (d * right - b * down) / determinant;
  const double dy = (a * down - c * right) / determinant;
  constexpr double kFurthestPx = 2.0;  // pictures that are magnified more have no fine detail
  if (!(w > 0.0 && std::abs(dx) <= kFurthestPx && std::abs(dy) <= kFurthestPx)) {
    return {MakeWarpCoefficients(m), {}};
  }
  for (int column = 0; column < 3; ++column) {
    m[column] += right * m[6 + column];
    m[3 + column] += down * m[6 + column];
  }
  return {MakeWarpCoefficients(m), {static_cast<float>(dx), static_cast<float>(dy)}};
}

TilePeak MeasurePeak(const PhaseCorrelationTables& tables, const PeakNeighbourhood& peak,
                     float reference_coverage, float current_coverage) {
  constexpr float kRoundingVariance = 1e-6F;
  const int side = 2 * tables.peak_radius + 1;
  const int middle = tables.peak_radius * side + tables.peak_radius;
  const std::span<const float> v = peak.samples;

  TilePeak result;
  result.coverage = current_coverage;
  result.noise = std::sqrt(std::max(peak.mean_square_outside, 0.0F));
  result.height = v[middle];
  if (!(result.height > 0.0F)) {
    result.height = 0.0F;
    result.covariance_xx = static_cast<float>(tables.tile_width * tables.tile_width) / 12.0F;
    result.covariance_yy = static_cast<float>(tables.tile_height * tables.tile_height) / 12.0F;
    return result;
  }

  const int shift_x = peak.x > tables.tile_width / 2 ? peak.x - tables.tile_width : peak.x;
  const int shift_y = peak.y > tables.tile_height / 2 ? peak.y - tables.tile_height : peak.y;
  const Offset offset = SubPixelPeak(v, tables.peak_radius);
  result.dx = static_cast<float>(shift_x) + offset.x;
  result.dy = static_cast<float>(shift_y) + offset.y;

  const float threshold = std::max(3.0F * result.noise, result.height / 16.0F);
  const Moments moments = FootprintMoments(v, tables.peak_radius, threshold);
  const float noise_ratio = result.noise / result.height;
  const float scale = noise_ratio * noise_ratio;
  result.covariance_xx = scale * moments.xx + kRoundingVariance;
  result.covariance_xy = scale * moments.xy;
  result.covariance_yy = scale * moments.yy + kRoundingVariance;

  result.valid = reference_coverage >= kMinCoverage && current_coverage >= kMinCoverage &&
                 result.height > kMinPeakToNoise * result.noise &&
                 result.height > tables.min_height && shift_x != tables.tile_width / 2 &&
                 shift_y != tables.tile_height / 2;
  return result;
}

}  // namespace windhover
