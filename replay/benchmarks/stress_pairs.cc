// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/stress_pairs.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "service/vision/homography.h"

namespace windhover::replay {
namespace {

constexpr double kMaxShiftShare = 0.35;  // of the width
constexpr double kMaxRotation = 10 * CV_PI / 180;
constexpr double kMaxScale = 0.10;
constexpr double kLowGain = 0.7;
constexpr double kHighGain = 1.4;
constexpr double kMaxNoise = 8;
constexpr int kPlacements = 500;  // tried before a picture counts as too small

// How the frame's camera differs from the reference's, about the middle of the picture.
struct View {
  double shift_px = 0;  // in a direction that is drawn
  double rotation = 0;  // radians
  double scale = 1;     // of ground seen
};

struct Sensor {
  double gain = 1;
  double noise_sigma = kStressNoise;
};

double Sign(cv::RNG& random) { return random.uniform(0, 2) == 0 ? -1 : 1; }

bool LiesInside(const Eigen::Matrix3d& picture_from_cut, cv::Size cut, cv::Size picture) {
  // The cubic interpolation reaches two pixels further.
  constexpr double kReach = 2;
  for (const Eigen::Vector2d& corner : PictureCorners(cut.width, cut.height)) {
    const Eigen::Vector2d place = Project(picture_from_cut, corner);
    if (place.x() < kReach || place.y() < kReach || place.x() > picture.width - 1 - kReach ||
        place.y() > picture.height - 1 - kReach) {
      return false;
    }
  }
  return true;
}

Eigen::Matrix3d Translation(double x, double y) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 2) = x;
  matrix(1, 2) = y;
  return matrix;
}

struct Placement {
  Eigen::Matrix3d picture_from_reference;
  Eigen::Matrix3d picture_from_frame;
};

std::optional<Placement> Place(cv::Size picture, cv::Size cut, const View& view, cv::RNG& random) {
  const double middle_x = (cut.width - 1) / 2.0;
  const double middle_y = (cut.height - 1) / 2.0;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = view.scale * Eigen::Rotation2Dd(view.rotation).toRotationMatrix();
  for (int i = 0; i < kPlacements; ++i) {
    // At whole pixels, so that nothing of the reference is interpolated.
    const int x = random.uniform(2, std::max(3, picture.width - cut.width - 2));
    const int y = random.uniform(2, std::max(3, picture.height - cut.height - 2));
    const double direction = random.uniform(0.0, 2 * CV_PI);
    const Placement placement = {Translation(x, y),
                                 Translation(x + middle_x + view.shift_px * std::cos(direction),
                                             y + middle_y + view.shift_px * std::sin(direction)) *
                                     turn * Translation(-middle_x, -middle_y)};
    if (LiesInside(placement.picture_from_reference, cut, picture) &&
        LiesInside(placement.picture_from_frame, cut, picture)) {
      return placement;
    }
  }
  return std::nullopt;
}

// Weights of the four pixels about a place `fraction` of the way from the second to the third
// (Keys 1981, a = -1/2).
std::array<double, 4> CubicWeights(double fraction) {
  const double t = fraction;
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
}

// OpenCV rounds the place of every sample to 1/32 px, which would be most of the error measured on
// the easy pairs. All that is sampled must lie inside the picture.
cv::Mat SampleCubic(const cv::Mat& picture, const Eigen::Matrix3d& picture_from_cut, cv::Size cut) {
  cv::Mat sampled(cut, CV_32F);
  for (int y = 0; y < cut.height; ++y) {
    for (int x = 0; x < cut.width; ++x) {
      const Eigen::Vector2d place = Project(picture_from_cut, {x, y});
      const int left = static_cast<int>(std::floor(place.x()));
      const int top = static_cast<int>(std::floor(place.y()));
      const std::array<double, 4> across = CubicWeights(place.x() - left);
      const std::array<double, 4> down = CubicWeights(place.y() - top);
      double value = 0;
      for (int row = 0; row < 4; ++row) {
        const std::uint8_t* pixels = picture.ptr(top - 1 + row) + left - 1;
        double sum = 0;
        for (int column = 0; column < 4; ++column) sum += across[column] * pixels[column];
        value += down[row] * sum;
      }
      sampled.at<float>(y, x) = static_cast<float>(value);
    }
  }
  return sampled;
}

cv::Mat Expose(cv::Mat seen, const Sensor& sensor, cv::RNG& random) {
  cv::Mat noise(seen.size(), CV_32F);
  random.fill(noise, cv::RNG::NORMAL, 0, sensor.noise_sigma);
  cv::Mat sampled;
  seen = sensor.gain * seen + noise;
  seen.convertTo(sampled, CV_8U);
  return sampled;
}

View MildView(cv::Size size, cv::RNG& random) {
  return {.shift_px = random.uniform(0.0, 0.1) * size.width,
          .rotation = random.uniform(-2.0, 2.0) * CV_PI / 180,
          .scale = random.uniform(0.98, 1.02)};
}

std::optional<StressPair> Cut(const cv::Mat& picture, cv::Size size, const View& view,
                              const Sensor& reference, const Sensor& frame, cv::RNG& random) {
  const std::optional<Placement> placement = Place(picture.size(), size, view, random);
  if (!placement) return std::nullopt;
  StressPair pair;
  pair.reference =
      Expose(SampleCubic(picture, placement->picture_from_reference, size), reference, random);
  pair.frame = Expose(SampleCubic(picture, placement->picture_from_frame, size), frame, random);
  pair.reference_from_frame =
      InverseHomography(placement->picture_from_reference) * placement->picture_from_frame;
  return pair;
}

}  // namespace

const char* NameOf(Stress stress) {
  switch (stress) {
    case Stress::kShift:
      return "shift";
    case Stress::kRotation:
      return "rotation";
    case Stress::kScale:
      return "scale";
    case Stress::kGain:
      return "gain";
    case Stress::kNoise:
      return "noise";
    case Stress::kCombined:
      return "combined";
  }
  return "";
}

const char* NameOf(Fault fault) {
  switch (fault) {
    case Fault::kCut:
      return "cut";
    case Fault::kBlack:
      return "black";
    case Fault::kMirrored:
      return "mirrored";
    case Fault::kBeyond:
      return "beyond";
    case Fault::kBlurred:
      return "blurred";
  }
  return "";
}

std::uint64_t MixSeed(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t state = 0;
  for (const std::uint64_t part : {a, b, c}) {
    // The finisher of S. Vigna's splitmix64.
    state += part + 0x9e3779b97f4a7c15U;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9U;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebU;
    state ^= state >> 31;
  }
  return state;
}

std::optional<StressPair> CutStressPair(const cv::Mat& picture, cv::Size size, Stress stress,
                                        double share, std::uint64_t seed) {
  cv::RNG random(seed);
  View view;
  Sensor reference;
  Sensor frame;
  const auto apply = [&](Stress one, double part) {
    const double sign = Sign(random);
    switch (one) {
      case Stress::kShift:
        view.shift_px = part * kMaxShiftShare * size.width;
        break;
      case Stress::kRotation:
        view.rotation = sign * part * kMaxRotation;
        break;
      case Stress::kScale:
        view.scale = 1 + sign * part * kMaxScale;
        break;
      case Stress::kGain:
        frame.gain = 1 + part * ((sign < 0 ? kLowGain : kHighGain) - 1);
        break;
      case Stress::kNoise:
        reference.noise_sigma = kStressNoise + part * (kMaxNoise - kStressNoise);
        frame.noise_sigma = reference.noise_sigma;
        break;
      case Stress::kCombined:
        break;
    }
  };
  if (stress == Stress::kCombined) {
    for (const Stress one : kStresses) apply(one, random.uniform(0.0, 1.0));
  } else {
    apply(stress, share);
  }
  return Cut(picture, size, view, reference, frame, random);
}

std::optional<StressPair> CutFaultPair(const cv::Mat& picture, const cv::Mat& other, cv::Size size,
                                       Fault fault, std::uint64_t seed) {
  cv::RNG random(seed);
  View view;
  if (fault == Fault::kBeyond) {
    view.rotation = Sign(random) * random.uniform(CV_PI / 3, CV_PI);
    view.scale = 1 / random.uniform(1.6, 2.5);
  } else if (fault == Fault::kBlurred) {
    // Without a motion, whoever finds nothing would be right.
    view = MildView(size, random);
  }
  std::optional<StressPair> pair = Cut(picture, size, view, {}, {}, random);
  if (!pair) return std::nullopt;
  switch (fault) {
    case Fault::kCut: {
      const std::optional<StressPair> elsewhere = Cut(other, size, {}, {}, {}, random);
      if (!elsewhere) return std::nullopt;
      pair->frame = elsewhere->frame;
      pair->reference_from_frame.reset();
      break;
    }
    case Fault::kBlack:
      pair->frame = Expose(cv::Mat::zeros(size, CV_32F), {}, random);
      pair->reference_from_frame.reset();
      break;
    case Fault::kMirrored:
      cv::flip(pair->frame, pair->frame, 1);
      pair->reference_from_frame.reset();
      break;
    case Fault::kBeyond:
      break;
    case Fault::kBlurred:
      cv::GaussianBlur(pair->frame, pair->frame, {0, 0}, random.uniform(8.0, 15.0));
      break;
  }
  return pair;
}

std::optional<StressPair> CutMildPair(const cv::Mat& picture, cv::Size size, double noise_sigma,
                                      std::uint64_t seed) {
  cv::RNG random(seed);
  const View view = MildView(size, random);
  const Sensor sensor = {.gain = 1, .noise_sigma = noise_sigma};
  return Cut(picture, size, view, sensor, sensor, random);
}

}  // namespace windhover::replay
