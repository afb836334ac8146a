// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/difference_threshold/difference_threshold_opencl.h"

#include <string>

#include "gpu-kernels/difference_threshold/difference_threshold_check.h"
#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/kernel_sources.h"

namespace windhover {
namespace {

using opencl::GlobalMemory;

class DifferenceThresholdOpenCl : public DifferenceThreshold {
 public:
  explicit DifferenceThresholdOpenCl(opencl::Context& context)
      : is_cpu_(context.is_cpu()),
        queue_(context),
        plain_(Compile(context, "-DGRADIENT=0"), "DifferenceThreshold"),
        with_gradient_(Compile(context, "-DGRADIENT=1"), "DifferenceThreshold") {}

  void Run(const GrayImage& frame, const GrayImage& background,
           const DifferenceThresholdSettings& settings, BitImage& seeds) override {
    CheckDifferenceThreshold(frame, background, settings, seeds);
    const int gain_64ths = GainIn64ths(settings);
    const std::size_t words = seeds.words.width();
    const std::size_t height = frame.height();
    const opencl::WorkSize size =
        is_cpu_
            ? opencl::WorkSize{.global = {1, opencl::RoundUp(height, 8), 1}, .local = {1, 8, 1}}
            : opencl::WorkSize{.global = {opencl::RoundUp(words, 8), opencl::RoundUp(height, 8), 1},
                               .local = {8, 8, 1}};
    (gain_64ths == 0 ? plain_ : with_gradient_)
        .Enqueue(queue_, size, frame, static_cast<cl_int>(frame.stride()), background,
                 static_cast<cl_int>(background.stride()), frame.width(), frame.height(),
                 settings.threshold, gain_64ths, seeds.words,
                 static_cast<cl_int>(seeds.words.stride()));
    queue_.Finish();
  }

 private:
  using ThresholdKernel = opencl::Kernel<GlobalMemory, cl_int, GlobalMemory, cl_int, cl_int, cl_int,
                                         cl_int, cl_int, GlobalMemory, cl_int>;

  static opencl::Program Compile(opencl::Context& context, const std::string& options) {
    if (context.is_cpu()) {
      try {
        return context.Compile(kDifferenceThresholdCl, options + " -DV=64");
      } catch (const DeviceError&) {
        // A compiler without vectors wider than OpenCL's.
      }
    }
    return context.Compile(kDifferenceThresholdCl, options + " -DV=16");
  }

  const bool is_cpu_;
  opencl::Queue queue_;
  ThresholdKernel plain_;
  ThresholdKernel with_gradient_;
};

}  // namespace

std::unique_ptr<DifferenceThreshold> MakeDifferenceThresholdOpenCl(opencl::Context& context) {
  return std::make_unique<DifferenceThresholdOpenCl>(context);
}

}  // namespace windhover
