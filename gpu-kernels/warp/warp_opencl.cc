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

// How the kernel is laid out on a device. Changes the speed, not the result.
struct Layout {
  int lanes = 1;
  int batch = 1;  // samples that are located, gathered and interpolated together
  bool whole_rows = false;
};

Layout LayoutFor(const opencl::Context& context) {
  if (!context.is_cpu()) return {};
  const int native = context.native_float_lanes();
  const int lanes = native >= 16 ? 16 : native >= 8 ? 8 : 4;
  return {.lanes = lanes, .batch = 64, .whole_rows = true};
}

class WarpOpenCl : public Warp {
 public:
  explicit WarpOpenCl(opencl::Context& context)
      : layout_(LayoutFor(context)), queue_(context), kernel_(Compile(context, layout_), "Warp") {}

  void Run(const GrayImage& source, const Matrix3& source_from_destination,
           GrayImage& destination) override {
    if (source.empty() || destination.empty() || &source == &destination) {
      throw std::invalid_argument("warp: source and destination must be two images");
    }
    const WarpCoefficients coefficients = MakeWarpCoefficients(source_from_destination);
    cl_float16 matrix = {};
    std::copy(coefficients.begin(), coefficients.end(), matrix.s);
    const std::size_t width = destination.width();
    const std::size_t height = destination.height();
    const opencl::WorkSize size =
        layout_.whole_rows
            ? opencl::WorkSize{.global = {1, opencl::RoundUp(height, 8), 1}, .local = {1, 8, 1}}
            : opencl::WorkSize{
                  .global = {opencl::RoundUp(width, 32), opencl::RoundUp(height, 4), 1},
                  .local = {32, 4, 1}};
    kernel_.Enqueue(queue_, size, source, source.width(), source.height(),
                    static_cast<cl_int>(source.stride()), matrix, destination, destination.width(),
                    destination.height(), static_cast<cl_int>(destination.stride()));
    queue_.Finish();
  }

 private:
  static opencl::Program Compile(opencl::Context& context, const Layout& layout) {
    std::string source(kLanesCl);
    source += kBilinearCl;
    source += kWarpCl;
    return context.Compile(source, "-DV=" + std::to_string(layout.lanes) + " -DBATCH=" +
                                       std::to_string(layout.batch) + " -cl-mad-enable");
  }

  Layout layout_;
  opencl::Queue queue_;
  opencl::Kernel<GlobalMemory, cl_int, cl_int, cl_int, cl_float16, GlobalMemory, cl_int, cl_int,
                 cl_int>
      kernel_;
};

}  // namespace

std::unique_ptr<Warp> MakeWarpOpenCl(opencl::Context& context) {
  return std::make_unique<WarpOpenCl>(context);
}

}  // namespace windhover
