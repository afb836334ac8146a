// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

namespace windhover {

// Transforms of real pictures whose sides are powers of two, 2 to 512, without a factor of their
// own: Inverse behind Forward multiplies by width * height.
//
//   samples    height x width values, row-major
//   spectrum   height x (width / 2 + 1) complex values, row-major, bin (0, 0) first, real and
//              imaginary part in turn: the left half, as the right one mirrors it
//
// Both must be aligned to 64 bytes. One object is used by one thread at a time.
class FourierTransform {
 public:
  virtual ~FourierTransform() = default;

  virtual void Forward(float* samples, float* spectrum) = 0;
  // Leaves nothing of use in the spectrum.
  virtual void Inverse(float* spectrum, float* samples) = 0;

 protected:
  // Throws std::invalid_argument for other sides.
  FourierTransform(int width, int height);
};

// Of our own: radix 2, a reference and a stand-in.
std::unique_ptr<FourierTransform> MakePlainFourierTransform(int width, int height);
// Only in builds with FFTW3 (WINDHOVER_FFTW in CMake).
std::unique_ptr<FourierTransform> MakeFftwFourierTransform(int width, int height);

// The fastest that the build has.
std::unique_ptr<FourierTransform> MakeFourierTransform(int width, int height);

}  // namespace windhover
