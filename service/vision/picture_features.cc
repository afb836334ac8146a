// SPDX-License-Identifier: Apache-2.0
#include "service/vision/picture_features.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>

namespace windhover {
namespace {

// Smaller pictures hold no pyramid, which the detectors take for granted.
constexpr int kLeastSidePx = 16;

// Lower than OpenCV's own: the ground may be hazy or dim. Where there is plenty, max_features
// leaves the strongest.
constexpr double kSiftContrast = 0.01;
constexpr float kAkazeThreshold = 5e-5F;
constexpr int kFastThreshold = 7;

constexpr float kOrbScale = 1.2F;
constexpr int kOrbLevels = 8;

// SIFT drops masked points after it has kept the strongest of all: with a mask it keeps all.
cv::Ptr<cv::Feature2D> MakeDetector(const FeatureRegistrationOptions& options, bool masked) {
  switch (options.detector) {
    case FeatureDetector::kSift:
      return cv::SIFT::create(masked ? 0 : options.max_features, 3, kSiftContrast);
    case FeatureDetector::kAkaze:
      return cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, kAkazeThreshold);
    case FeatureDetector::kOrb:
      return cv::ORB::create(options.max_features, kOrbScale, kOrbLevels, 31, 0, 2,
                             cv::ORB::HARRIS_SCORE, 31, kFastThreshold);
  }
  throw std::invalid_argument("no such feature detector");
}

// A coordinate of level i of ORB's pyramid, whose sides are whole numbers and whose pixels cover
// those of the picture from border to border, though ORB multiplies by the level's nominal scale.
double OrbCoordinate(float reported, int octave, int side) {
  const float scale = std::pow(kOrbScale, static_cast<float>(octave));
  const double true_scale = static_cast<double>(side) / cvRound(static_cast<float>(side) / scale);
  return (reported / scale + 0.5) * true_scale - 0.5;
}

// Where the point lies in the picture. What is added here is nothing that a shift between two
// pictures would show, but a rotation or a zoom does.
Eigen::Vector2d PixelOf(const cv::KeyPoint& point, FeatureDetector detector, int width,
                        int height) {
  switch (detector) {
    case FeatureDetector::kSift:
      // SIFT's first octave is the picture at twice its size, the first pixel of which has its
      // centre at -1/4 px.
      return {point.pt.x - 0.25, point.pt.y - 0.25};
    case FeatureDetector::kOrb:
      return {OrbCoordinate(point.pt.x, point.octave, width),
              OrbCoordinate(point.pt.y, point.octave, height)};
    case FeatureDetector::kAkaze:
      break;
  }
  return {point.pt.x, point.pt.y};
}

// As synthetic pairs show. ORB leaves points on whole pixels of the pyramid's level. What is
// refined below the pixel is placed alike on all levels (eq. 2.8): large features are smeared,
// small ones drowned in noise.
double SigmaPx(const cv::KeyPoint& point, FeatureDetector detector) {
  constexpr double kRefinedPx = 0.3;
  constexpr double kWholePx = 0.4;
  if (detector != FeatureDetector::kOrb) return kRefinedPx;
  return kWholePx * std::pow(kOrbScale, static_cast<float>(point.octave));
}

cv::Mat View(const MappedImage<const std::uint8_t>& pixels) {
  // OpenCV has no view of what must not be written; the detectors read only.
  return cv::Mat(pixels.height(), pixels.width(), CV_8UC1,
                 const_cast<std::uint8_t*>(pixels.data()),  // NOLINT
                 static_cast<std::size_t>(pixels.stride()));
}

// Indices of the strongest points in an order that does not depend on the detector's threads.
std::vector<int> Strongest(const std::vector<cv::KeyPoint>& points, int count) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const cv::KeyPoint& p = points[i];
    return std::tuple(-p.response, p.pt.y, p.pt.x, p.size, p.angle);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  if (static_cast<int>(order.size()) > count) order.resize(count);
  return order;
}

}  // namespace

PictureFeatures DetectFeatures(const GrayImage& picture, const GrayImage* mask,
                               const FeatureRegistrationOptions& options) {
  PictureFeatures features;
  features.width = picture.width();
  features.height = picture.height();
  if (mask != nullptr && (mask->width() != picture.width() || mask->height() != picture.height())) {
    throw std::invalid_argument("mask: its size differs from the picture's");
  }
  if (std::min(features.width, features.height) < kLeastSidePx) return features;

  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  {
    const auto pixels = picture.Read();
    std::optional<MappedImage<const std::uint8_t>> mask_pixels;
    if (mask != nullptr) mask_pixels.emplace(mask->Read());
    MakeDetector(options, mask != nullptr)
        ->detectAndCompute(View(pixels), mask_pixels ? View(*mask_pixels) : cv::Mat(), points,
                           descriptors);
  }
  for (const int i : Strongest(points, options.max_features)) {
    features.x_in_picture.push_back(
        PixelOf(points[i], options.detector, features.width, features.height));
    features.sigma_px.push_back(SigmaPx(points[i], options.detector));
    features.descriptors.push_back(descriptors.row(i));
  }
  return features;
}

}  // namespace windhover
