// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/warp/warp_opencl.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/kernel_sources.h"
#include "gpu-kernels/warp/warp_coefficients.h"

namespace windhover {
namespace {

using opencl::GlobalMemory;

class WarpOpenCl : public Warp {
 public:
  WarpOpenCl(opencl::Context& context, const opencl::RowLayout& layout)
      : layout_(layout), queue_(context), kernel_(Compile(context, layout), "Warp") {}

  void Run(const GrayImage& source, const Matrix3& source_from_destination,
           GrayImage& destination) override {
    if (source.empty() || destination.empty() || &source == &destination) {
      throw std::invalid_argument("warp: source and destination must be two images");
    }
    const WarpCoefficients coefficients = MakeWarpCoefficients(source_from_destination);
    cl_float16 matrix = {};
    std::copy(coefficients.begin(), coefficients.end(), matrix.s);
    const int batches = (destination.width() + Batch(layout_) - 1) / Batch(layout_);
    kernel_.Enqueue(queue_, layout_.Size(batches, destination.height()), source, source.width(),
                    source.height(), static_cast<cl_int>(source.stride()), matrix, destination,
                    destination.width(), destination.height(),
                    static_cast<cl_int>(destination.stride()));
    queue_.Finish();
  }

 private:
  // Samples that are located, gathered and interpolated together.
  static int Batch(const opencl::RowLayout& layout) {
    return layout.whole_rows ? 64 : layout.float_lanes;
  }

  static opencl::Program Compile(opencl::Context& context, const opencl::RowLayout& layout) {
    std::string source(kLanesCl);
    source += kBilinearCl;
    source += kWarpCl;
    return context.Compile(source, "-DV=" + std::to_string(layout.float_lanes) + " -DBATCH=" +
                                       std::to_string(Batch(layout)) + " -cl-mad-enable");
  }

  const opencl::RowLayout layout_;
  opencl::Queue queue_;
  opencl::Kernel<GlobalMemory, cl_int, cl_int, cl_int, cl_float16, GlobalMemory, cl_int, cl_int,
                 cl_int>
      kernel_;
};

}  // namespace

std::unique_ptr<Warp> MakeWarpOpenCl(opencl::Context& context, const opencl::RowLayout& layout) {
  return std::make_unique<WarpOpenCl>(context, layout);
}

}  // namespace windhover
