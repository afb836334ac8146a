// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/phase_correlation/fourier_transform_cpu.h"

#include <bit>
#include <stdexcept>

namespace windhover {

FourierTransform::FourierTransform(int width, int height) {
  for (const int side : {width, height}) {
    if (side < 2 || side > 512 || !std::has_single_bit(static_cast<unsigned>(side))) {
      throw std::invalid_argument("Fourier transform: sides must be powers of two, 2 to 512");
    }
  }
}

std::unique_ptr<FourierTransform> MakeFourierTransform(int width, int height) {
#ifdef WINDHOVER_HAS_FFTW
  return MakeFftwFourierTransform(width, height);
#else
  return MakePlainFourierTransform(width, height);
#endif
}

}  // namespace windhover
