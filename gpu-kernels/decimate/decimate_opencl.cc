// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/decimate/decimate_opencl.h"

#include <array>
#include <memory>
#include <string>

#include "gpu-kernels/decimate/decimate_check.h"
#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/kernel_sources.h"

namespace windhover {
namespace {

using opencl::GlobalMemory;

class DecimateOpenCl : public Decimate {
 public:
  explicit DecimateOpenCl(opencl::Context& context)
      : context_(context.shared_from_this()), queue_(context) {}

  void Run(const GrayImage& source, int factor, GrayImage& destination) override {
    CheckDecimate(source, factor, destination);
    const std::size_t width = destination.width();
    const std::size_t height = destination.height();
    const opencl::WorkSize size =
        context_->is_cpu()
            ? opencl::WorkSize{.global = {1, opencl::RoundUp(height, 8), 1}, .local = {1, 8, 1}}
            : opencl::WorkSize{
                  .global = {opencl::RoundUp(width, 32), opencl::RoundUp(height, 4), 1},
                  .local = {32, 4, 1}};
    KernelFor(factor).Enqueue(queue_, size, source, static_cast<cl_int>(source.stride()),
                              destination, destination.width(), destination.height(),
                              static_cast<cl_int>(destination.stride()));
    queue_.Finish();
  }

 private:
  using DecimateKernel = opencl::Kernel<GlobalMemory, cl_int, GlobalMemory, cl_int, cl_int, cl_int>;

  // One kernel a factor, compiled when it is first asked for.
  const DecimateKernel& KernelFor(int factor) {
    std::unique_ptr<DecimateKernel>& kernel = kernels_[factor];
    if (!kernel) {
      const std::string options =
          "-DFACTOR=" + std::to_string(factor) + (context_->is_cpu() ? " -DV=16" : " -DV=1");
      kernel =
          std::make_unique<DecimateKernel>(context_->Compile(kDecimateCl, options), "Decimate");
    }
    return *kernel;
  }

  const std::shared_ptr<opencl::Context> context_;
  opencl::Queue queue_;
  std::array<std::unique_ptr<DecimateKernel>, kMaxDecimation + 1> kernels_;
};

}  // namespace

std::unique_ptr<Decimate> MakeDecimateOpenCl(opencl::Context& context) {
  return std::make_unique<DecimateOpenCl>(context);
}

}  // namespace windhover
