// SPDX-License-Identifier: Apache-2.0
#include "tests/support/synthetic_ground.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

namespace windhover {

SyntheticGround::SyntheticGround(std::uint32_t seed) : lattice_(kLattice * kLattice) {
  std::mt19937 random(seed);
  for (float& value : lattice_) value = static_cast<float>(random() % 2001) / 1000.0F - 1.0F;
}

// Value noise of six octaves with a cubic fade: continuous slopes, no favoured direction at the
// scale of a tile.
double SyntheticGround::At(double x, double y) const {
  double sum = 0.0;
  double amplitude = 60.0;
  for (double period = 96.0; period > 2.5; period *= 0.5, amplitude *= 0.75) {
    const double u = x / period + 17.3 * period;
    const double v = y / period + 5.1 * period;
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    const auto fade = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double fu = fade(u - i);
    const double fv = fade(v - j);
    const auto node = [&](int a, int b) {
      return static_cast<double>(lattice_[((b % kLattice + kLattice) % kLattice) * kLattice +
                                          (a % kLattice + kLattice) % kLattice]);
    };
    const double top = node(i, j) + fu * (node(i + 1, j) - node(i, j));
    const double bottom = node(i, j + 1) + fu * (node(i + 1, j + 1) - node(i, j + 1));
    sum += amplitude * (top + fv * (bottom - top));
  }
  return std::clamp(128.0 + sum, 20.0, 235.0);
}

void SyntheticGround::Render(const Eigen::Matrix3d& ground_from_frame, double noise_sigma,
                             std::uint32_t noise_seed, GrayImage& frame,
                             const std::function<double(int, int, double)>& paint) const {
  std::mt19937 random(noise_seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const auto view = frame.Write();
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      const Eigen::Vector3d p = ground_from_frame * Eigen::Vector3d(x, y, 1);
      double value = At(p.x() / p.z(), p.y() / p.z());
      if (paint) value = paint(x, y, value);
      if (noise_sigma > 0.0) value += noise_sigma * noise(random);
      view.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
}

Eigen::Matrix3d CameraMotion(int width, int height, double radians, double zoom, double dx,
                             double dy, double perspective) {
  Eigen::Matrix3d to_centre = Eigen::Matrix3d::Identity();
  to_centre.topRightCorner<2, 1>() << -0.5 * (width - 1), -0.5 * (height - 1);
  Eigen::Matrix3d motion = Eigen::Matrix3d::Identity();
  motion.topLeftCorner<2, 2>() << zoom * std::cos(radians), -zoom * std::sin(radians),
      zoom * std::sin(radians), zoom * std::cos(radians);
  motion.topRightCorner<2, 1>() << dx, dy;
  motion.bottomLeftCorner<1, 2>() << perspective, -0.5 * perspective;
  const Eigen::Matrix3d m = to_centre.inverse() * motion * to_centre;
  return m / m(2, 2);
}

double HomographyRms(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, int width, int height) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < height; y += std::max(1, height / 24)) {
    for (int x = 0; x < width; x += std::max(1, width / 32), ++count) {
      const Eigen::Vector3d p(x, y, 1);
      sum += ((a * p).hnormalized() - (b * p).hnormalized()).squaredNorm();
    }
  }
  return std::sqrt(sum / count);
}

}  // namespace windhover
