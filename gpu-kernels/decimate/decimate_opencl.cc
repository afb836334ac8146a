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
  DecimateOpenCl(opencl::Context& context, const opencl::RowLayout& layout)
      : context_(context.shared_from_this()), layout_(layout), queue_(context) {}

  void Run(const GrayImage& source, int factor, GrayImage& destination) override {
    CheckDecimate(source, factor, destination);
    const int groups = (destination.width() + Lanes() - 1) / Lanes();
    KernelFor(factor).Enqueue(queue_, layout_.Size(groups, destination.height()), source,
                              static_cast<cl_int>(source.stride()), destination,
                              destination.width(), destination.height(),
                              static_cast<cl_int>(destination.stride()));
    queue_.Finish();
  }

 private:
  using DecimateKernel = opencl::Kernel<GlobalMemory, cl_int, GlobalMemory, cl_int, cl_int, cl_int>;

  int Lanes() const { return layout_.whole_rows ? 16 : 1; }

  // One kernel a factor, compiled when it is first asked for.
  const DecimateKernel& KernelFor(int factor) {
    std::unique_ptr<DecimateKernel>& kernel = kernels_[factor];
    if (!kernel) {
      const std::string options =
          "-DFACTOR=" + std::to_string(factor) + " -DV=" + std::to_string(Lanes());
      kernel =
          std::make_unique<DecimateKernel>(context_->Compile(kDecimateCl, options), "Decimate");
    }
    return *kernel;
  }

  const std::shared_ptr<opencl::Context> context_;
  const opencl::RowLayout layout_;
  opencl::Queue queue_;
  std::array<std::unique_ptr<DecimateKernel>, kMaxDecimation + 1> kernels_;
};

}  // namespace

std::unique_ptr<Decimate> MakeDecimateOpenCl(opencl::Context& context,
                                             const opencl::RowLayout& layout) {
  return std::make_unique<DecimateOpenCl>(context, layout);
}

}  // namespace windhover
