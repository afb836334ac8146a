// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/ground_residual.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "replay/scoring/oriented.h"

namespace windhover::replay {
namespace {

// Smoothing, so that interpolation and differences take little from what is left: standard
// deviation and number of taps.
constexpr double kSmoothingPx = 1;
constexpr int kTaps = 7;
// What smoothing and interpolation reach over.
constexpr int kBorderPx = 5;
constexpr std::size_t kSteepestPart = 10;  // one in so many
// Median absolute value of a normal distribution, over its standard deviation.
constexpr double kNormalMedian = 0.6745;

float MedianOf(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Where each pixel of b lies in a: a map for cv::remap. Pixels that are not in both come out of
// `common`.
cv::Mat MapInto(const Eigen::Matrix3d& a_from_b, cv::Size size, std::vector<cv::Point>& common) {
  const Eigen::Matrix3d h = Oriented(a_from_b);
  cv::Mat map(size, CV_32FC2);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Eigen::Vector3d there = h * Eigen::Vector3d(x, y, 1);
      const double u = there.x() / there.z();
      const double v = there.y() / there.z();
      const bool inside = there.z() > 0 && u >= kBorderPx && v >= kBorderPx &&
                          u <= size.width - 1 - kBorderPx && v <= size.height - 1 - kBorderPx;
      map.at<cv::Vec2f>(y, x) =
          inside ? cv::Vec2f(static_cast<float>(u), static_cast<float>(v)) : cv::Vec2f(-1, -1);
      if (inside && x >= kBorderPx && y >= kBorderPx && x < size.width - kBorderPx &&
          y < size.height - kBorderPx) {
        common.emplace_back(x, y);
      }
    }
  }
  return map;
}

void Smooth(const cv::Mat& picture, cv::Mat& smooth) {
  picture.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {kTaps, kTaps}, kSmoothingPx);
}

// What smoothing leaves of the standard deviation of white noise.
double NoiseLeft() {
  const cv::Mat kernel = cv::getGaussianKernel(kTaps, kSmoothingPx, CV_64F);
  return kernel.dot(kernel);
}

cv::Mat GradientLength(const cv::Mat& picture) {
  cv::Mat dx;
  cv::Mat dy;
  cv::Mat length;
  cv::Sobel(picture, dx, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(picture, dy, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::magnitude(dx, dy, length);
  return length;
}

// Standard deviation of the noise, at the given pixels.
double NoiseDeviation(const cv::Mat& picture, const std::vector<cv::Point>& pixels) {
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat response;
  cv::filter2D(picture, response, CV_32F, kernel);
  double sum = 0;
  for (const cv::Point& pixel : pixels) sum += std::abs(response.at<float>(pixel));
  return std::sqrt(std::numbers::pi / 2) / 6 * sum / static_cast<double>(pixels.size());
}

double MedianAt(const cv::Mat& picture, const std::vector<cv::Point>& pixels) {
  std::vector<float> values;
  values.reserve(pixels.size());
  for (const cv::Point& pixel : pixels) values.push_back(picture.at<float>(pixel));
  return MedianOf(values);
}

std::vector<float> Differences(const cv::Mat& a, const cv::Mat& b,
                               const std::vector<cv::Point>& pixels) {
  std::vector<float> differences;
  differences.reserve(pixels.size());
  for (const cv::Point& pixel : pixels) {
    differences.push_back(a.at<float>(pixel) - b.at<float>(pixel));
  }
  return differences;
}

// Median absolute difference at the steep pixels, once the change of brightness is taken out. That
// is seen where the picture is flat: there an error of the warp does not look like one.
double MedianDifference(const cv::Mat& a, const cv::Mat& b, const std::vector<cv::Point>& steep,
                        const std::vector<cv::Point>& flat) {
  std::vector<float> at_flat = Differences(a, b, flat);
  const float brighter = MedianOf(at_flat);
  std::vector<float> differences = Differences(a, b, steep);
  for (float& difference : differences) difference = std::abs(difference - brighter);
  return MedianOf(differences);
}

}  // namespace

double GroundResidual::misplacement_px() const {
  const double beyond = std::sqrt(std::max(0.0, warped * warped - noise * noise));
  // |cos| of the angle between error and gradient has its median at 45 degrees.
  const double across = gradient / std::numbers::sqrt2;
  return across > 0 ? beyond / across : 0;
}

std::optional<GroundResidual> MeasureGroundResidual(const cv::Mat& a, const cv::Mat& b,
                                                    const Eigen::Matrix3d& a_from_b) {
  if (!(std::abs(Oriented(a_from_b).determinant()) > 0)) return std::nullopt;
  std::vector<cv::Point> common;
  const cv::Mat map = MapInto(a_from_b, b.size(), common);
  if (common.size() < kLeastResidualPixels) return std::nullopt;
  cv::Mat a_smooth;
  cv::Mat b_smooth;
  cv::Mat warped;
  Smooth(a, a_smooth);
  Smooth(b, b_smooth);
  cv::remap(a_smooth, warped, map, cv::noArray(), cv::INTER_CUBIC);
  const cv::Mat gradient = GradientLength(b_smooth);
  const auto steeper = [&](const cv::Point& p, const cv::Point& q) {
    return gradient.at<float>(p) > gradient.at<float>(q);
  };
  const auto middle = common.begin() + static_cast<std::ptrdiff_t>(common.size() / 2);
  const auto tenth = common.begin() + static_cast<std::ptrdiff_t>(common.size() / kSteepestPart);
  std::nth_element(common.begin(), middle, common.end(), steeper);
  std::nth_element(common.begin(), tenth, middle, steeper);
  const std::vector<cv::Point> steep(common.begin(), tenth);
  const std::vector<cv::Point> flat(middle, common.end());
  GroundResidual residual;
  residual.pixels = static_cast<int>(steep.size());
  residual.warped = MedianDifference(warped, b_smooth, steep, flat);
  residual.unwarped = MedianDifference(a_smooth, b_smooth, steep, flat);
  residual.gradient = MedianAt(gradient, steep);
  // Both pictures have their share of it.
  residual.noise = kNormalMedian * std::sqrt(2.0) * NoiseLeft() * NoiseDeviation(b, flat);
  return residual;
}

}  // namespace windhover::replay
