// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "gpu-kernels/phase_correlation/fourier_transform_cpu.h"

namespace windhover {
namespace {

// Complex numbers as planes of real and of imaginary parts.
struct Planes {
  float* re;
  float* im;
};

// exp(-2 pi i k / count) for the first half of k.
struct Twiddles {
  explicit Twiddles(int count) {
    for (int k = 0; k < count / 2; ++k) {
      const double angle = -2.0 * std::numbers::pi * k / count;
      re.push_back(static_cast<float>(std::cos(angle)));
      im.push_back(static_cast<float>(std::sin(angle)));
    }
  }
  std::vector<float> re;
  std::vector<float> im;
};

// Exchanges each row with that of the mirrored bits of its number.
void ReverseBits(const Planes& values, int rows, int columns) {
  for (int row = 1, mirrored = 0; row < rows; ++row) {
    int bit = rows / 2;
    for (; (mirrored & bit) != 0; bit /= 2) mirrored ^= bit;
    mirrored |= bit;
    if (row >= mirrored) continue;
    for (float* plane : {values.re, values.im}) {
      std::swap_ranges(plane + row * columns, plane + (row + 1) * columns,
                       plane + mirrored * columns);
    }
  }
}

// Radix 2, decimation in time: forward transforms of all columns, each of `rows` values, in place.
// The innermost loop goes along rows, where the compiler can use vectors.
void TransformColumns(const Planes& values, int rows, int columns, const Twiddles& twiddles) {
  ReverseBits(values, rows, columns);
  for (int half = 1; half < rows; half *= 2) {
    for (int k = 0; k < half; ++k) {
      const float turn_re = twiddles.re[k * (rows / 2 / half)];
      const float turn_im = twiddles.im[k * (rows / 2 / half)];
      for (int row = k; row < rows; row += 2 * half) {
        float* a_re = values.re + row * columns;
        float* a_im = values.im + row * columns;
        float* b_re = a_re + half * columns;
        float* b_im = a_im + half * columns;
        for (int x = 0; x < columns; ++x) {
          const float re = turn_re * b_re[x] - turn_im * b_im[x];
          const float im = turn_re * b_im[x] + turn_im * b_re[x];
          b_re[x] = a_re[x] - re, b_im[x] = a_im[x] - im;
          a_re[x] += re, a_im[x] += im;
        }
      }
    }
  }
}

class PlainFourierTransform : public FourierTransform {
 public:
  PlainFourierTransform(int width, int height)
      : FourierTransform(width, height),
        width_(width),
        height_(height),
        bins_(width / 2 + 1),
        along_rows_(width),
        along_columns_(height),
        re_(width * height),
        im_(width * height),
        turned_re_(width * height),
        turned_im_(width * height) {}

  // Rows are transformed as columns of the transposed picture.
  void Forward(float* samples, float* spectrum) override {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) turned_re_[x * height_ + y] = samples[y * width_ + x];
    }
    std::fill(turned_im_.begin(), turned_im_.end(), 0.0F);
    TransformColumns(Turned(), width_, height_, along_rows_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < bins_; ++x) {
        re_[y * bins_ + x] = turned_re_[x * height_ + y];
        im_[y * bins_ + x] = turned_im_[x * height_ + y];
      }
    }
    TransformColumns(Upright(), height_, bins_, along_columns_);
    for (int i = 0; i < height_ * bins_; ++i) {
      spectrum[2 * i] = re_[i];
      spectrum[2 * i + 1] = im_[i];
    }
  }

  // An inverse transform is a forward one between conjugates, and the result here is real.
  void Inverse(float* spectrum, float* samples) override {
    for (int i = 0; i < height_ * bins_; ++i) {
      re_[i] = spectrum[2 * i];
      im_[i] = -spectrum[2 * i + 1];
    }
    TransformColumns(Upright(), height_, bins_, along_columns_);
    // Each row is now the half spectrum of a real one: its other half is the conjugate.
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const int bin = std::min(x, width_ - x);
        turned_re_[x * height_ + y] = re_[y * bins_ + bin];
        turned_im_[x * height_ + y] = bin == x ? im_[y * bins_ + bin] : -im_[y * bins_ + bin];
      }
    }
    TransformColumns(Turned(), width_, height_, along_rows_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) samples[y * width_ + x] = turned_re_[x * height_ + y];
    }
  }

 private:
  Planes Upright() { return {re_.data(), im_.data()}; }
  Planes Turned() { return {turned_re_.data(), turned_im_.data()}; }

  const int width_;
  const int height_;
  const int bins_;
  const Twiddles along_rows_;
  const Twiddles along_columns_;
  // height x bins
  std::vector<float> re_;
  std::vector<float> im_;
  // width x height
  std::vector<float> turned_re_;
  std::vector<float> turned_im_;
};

}  // namespace

std::unique_ptr<FourierTransform> MakePlainFourierTransform(int width, int height) {
  return std::make_unique<PlainFourierTransform>(width, height);
}

}  // namespace windhover
