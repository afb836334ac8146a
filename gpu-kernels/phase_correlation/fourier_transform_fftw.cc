// SPDX-License-Identifier: Apache-2.0
#include <fftw3.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <stdexcept>

#include "gpu-kernels/phase_correlation/fourier_transform_cpu.h"

namespace windhover {
namespace {

// FFTW's planner is not thread-safe; executing a plan is.
std::mutex& PlannerMutex() {
  static std::mutex mutex;
  return mutex;
}

struct FftwFree {
  void operator()(float* memory) const { fftwf_free(memory); }
};

fftwf_complex* AsComplex(float* values) { return reinterpret_cast<fftwf_complex*>(values); }

class FftwFourierTransform : public FourierTransform {
 public:
  // Measured plans differ from run to run, and with them the last bits of the result; at these
  // sides estimated ones are as fast.
  FftwFourierTransform(int width, int height) : FourierTransform(width, height) {
    // What plans are made for: any memory of that alignment does.
    const auto allocate = [](std::size_t floats) {
      return std::unique_ptr<float, FftwFree>(fftwf_alloc_real(floats));
    };
    const auto samples = allocate(static_cast<std::size_t>(width) * height);
    const auto spectrum = allocate(static_cast<std::size_t>(width + 2) * height);
    const std::lock_guard lock(PlannerMutex());
    forward_ = fftwf_plan_dft_r2c_2d(height, width, samples.get(), AsComplex(spectrum.get()),
                                     FFTW_ESTIMATE);
    inverse_ = fftwf_plan_dft_c2r_2d(height, width, AsComplex(spectrum.get()), samples.get(),
                                     FFTW_ESTIMATE);
    if (forward_ == nullptr || inverse_ == nullptr) {
      Destroy();
      throw std::runtime_error("phase correlation: FFTW made no plan");
    }
  }
  FftwFourierTransform(const FftwFourierTransform&) = delete;
  FftwFourierTransform& operator=(const FftwFourierTransform&) = delete;
  ~FftwFourierTransform() override {
    const std::lock_guard lock(PlannerMutex());
    Destroy();
  }

  void Forward(float* samples, float* spectrum) override {
    fftwf_execute_dft_r2c(forward_, samples, AsComplex(spectrum));
  }
  void Inverse(float* spectrum, float* samples) override {
    fftwf_execute_dft_c2r(inverse_, AsComplex(spectrum), samples);
  }

 private:
  void Destroy() {
    if (forward_ != nullptr) fftwf_destroy_plan(forward_);
    if (inverse_ != nullptr) fftwf_destroy_plan(inverse_);
  }

  fftwf_plan forward_ = nullptr;
  fftwf_plan inverse_ = nullptr;
};

}  // namespace

std::unique_ptr<FourierTransform> MakeFftwFourierTransform(int width, int height) {
  return std::make_unique<FftwFourierTransform>(width, height);
}

}  // namespace windhover
