// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/difference_threshold/difference_threshold_opencl.h"

#include <algorithm>
#include <string>

#include "gpu-kernels/difference_threshold/difference_threshold_check.h"
#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/kernel_sources.h"

namespace windhover {
namespace {

using opencl::GlobalMemory;

class DifferenceThresholdOpenCl : public DifferenceThreshold {
 public:
  DifferenceThresholdOpenCl(opencl::Context& context, const opencl::RowLayout& layout)
      : layout_(layout),
        queue_(context),
        plain_(Compile(context, "-DGRADIENT=0"), "DifferenceThreshold"),
        with_gradient_(Compile(context, "-DGRADIENT=1"), "DifferenceThreshold") {}

  void Run(const GrayImage& frame, const GrayImage& background,
           const DifferenceThresholdSettings& settings, BitImage& seeds) override {
    CheckDifferenceThreshold(frame, background, settings, seeds);
    const int gain_64ths = GainIn64ths(settings);
    (gain_64ths == 0 ? plain_ : with_gradient_)
        .Enqueue(queue_, layout_.Size(seeds.words.width(), frame.height()), frame,
                 static_cast<cl_int>(frame.stride()), background,
                 static_cast<cl_int>(background.stride()), frame.width(), frame.height(),
                 settings.threshold, gain_64ths, seeds.words,
                 static_cast<cl_int>(seeds.words.stride()));
    queue_.Finish();
  }

 private:
  using ThresholdKernel = opencl::Kernel<GlobalMemory, cl_int, GlobalMemory, cl_int, cl_int, cl_int,
                                         cl_int, cl_int, GlobalMemory, cl_int>;

  opencl::Program Compile(opencl::Context& context, const std::string& options) const {
    // The kernel has no narrower vectors: a word takes 32 pixels in any case.
    return opencl::CompileForByteLanes(context, kDifferenceThresholdCl, options,
                                       std::max(layout_.byte_lanes, 16));
  }

  const opencl::RowLayout layout_;
  opencl::Queue queue_;
  ThresholdKernel plain_;
  ThresholdKernel with_gradient_;
};

}  // namespace

std::unique_ptr<DifferenceThreshold> MakeDifferenceThresholdOpenCl(
    opencl::Context& context, const opencl::RowLayout& layout) {
  return std::make_unique<DifferenceThresholdOpenCl>(context, layout);
}

}  // namespace windhover
