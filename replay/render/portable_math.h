// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

// Random numbers, noise and circular functions that come out the same to the bit wherever IEEE 754
// arithmetic is kept: nothing here calls the C library beyond what IEEE defines exactly.

namespace windhover::replay {

inline constexpr double kPi = 3.14159265358979323846;

// A bijective mix of 64 bits (the finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t Mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}
constexpr std::uint64_t Mix(std::uint64_t a, std::uint64_t b) { return Mix(a ^ Mix(b)); }

// Random numbers that are a function of (key, how many were drawn).
class Random {
 public:
  explicit Random(std::uint64_t key) : key_(Mix(key)) {}

  std::uint64_t Bits() { return Mix(key_ + counter_++ * 0xD1B54A32D192ED03U); }
  // [0, 1)
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  // 0 to count - 1
  int Below(int count) { return static_cast<int>(Uniform() * count); }
  bool Chance(double probability) { return Uniform() < probability; }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

// Zero mean, unit variance, nearly Gaussian (to 4.9 standard deviations): the sum of eight bytes.
inline float NormalFromBits(std::uint64_t bits) {
  constexpr std::uint64_t kEven = 0x00FF00FF00FF00FFU;
  const std::uint64_t pairs = (bits & kEven) + ((bits >> 8) & kEven);
  const int sum = static_cast<int>((pairs * 0x0001000100010001U) >> 48);
  return (static_cast<float>(sum) - 1020.0F) * (1.0F / 209.01F);
}

// The greatest integer that is not above `value`, which fits an int; quicker than std::floor.
inline int Floor(double value) {
  const int cut = static_cast<int>(value);
  return cut > value ? cut - 1 : cut;
}

// Smooth noise in [-1, 1] with a grid of period 1 (value noise).
inline float Noise(float x, float y, std::uint32_t seed) {
  const int cell_x = static_cast<int>(x) - (x < 0 ? 1 : 0);
  const int cell_y = static_cast<int>(y) - (y < 0 ? 1 : 0);
  const auto fx = static_cast<float>(cell_x);
  const auto fy = static_cast<float>(cell_y);
  const auto ix = static_cast<std::uint32_t>(cell_x);
  const auto iy = static_cast<std::uint32_t>(cell_y);
  const auto corner = [seed](std::uint32_t cx, std::uint32_t cy) {
    std::uint32_t h = cx * 0x8DA6B343U ^ cy * 0xD8163841U ^ seed * 0xCB1AB31FU;
    h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
    h = (h ^ (h >> 12)) * 0x297A2D39U;
    return static_cast<float>(static_cast<std::int32_t>(h ^ (h >> 15))) * 0x1.0p-31F;
  };
  float u = x - fx;
  float v = y - fy;
  u = u * u * (3.0F - 2.0F * u);
  v = v * v * (3.0F - 2.0F * v);
  const float top = corner(ix, iy) * (1 - u) + corner(ix + 1, iy) * u;
  const float bottom = corner(ix, iy + 1) * (1 - u) + corner(ix + 1, iy + 1) * u;
  return top * (1 - v) + bottom * v;
}

// Radians; |x| up to about 1e5. Error below 1e-14.
inline double Sine(double x) {
  const double quarter = std::nearbyint(x * (2.0 / kPi));
  const double r = (x - quarter * 1.57079632673412561417) - quarter * 6.07710050650619224932e-11;
  const double q = r * r;
  const auto octant = static_cast<std::int64_t>(quarter) & 3;
  double value = 0.0;
  if ((octant & 1) != 0) {
    value =
        1 + q * (-1.0 / 2 +
                 q * (1.0 / 24 + q * (-1.0 / 720 +
                                      q * (1.0 / 40320 + q * (-1.0 / 3628800 +
                                                              q * (1.0 / 479001600 +
                                                                   q * (-1.0 / 87178291200.0)))))));
  } else {
    value =
        r * (1 + q * (-1.0 / 6 +
                      q * (1.0 / 120 + q * (-1.0 / 5040 +
                                            q * (1.0 / 362880 + q * (-1.0 / 39916800 +
                                                                     q * (1.0 / 6227020800.0)))))));
  }
  return (octant & 2) != 0 ? -value : value;
}
inline double Cosine(double x) { return Sine(x + kPi / 2); }

}  // namespace windhover::replay
