// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/temporal_median/temporal_median_opencl.h"

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/kernel_sources.h"
#include "gpu-kernels/temporal_median/temporal_median_check.h"

namespace windhover {
namespace {

using opencl::GlobalMemory;

// A kernel that takes up to kSlots frames as arguments of their own; unused ones repeat a frame.
template <std::size_t kSlots>
class MedianOfSlots {
 public:
  explicit MedianOfSlots(const opencl::Program& program) : kernel_(program, "TemporalMedian") {}

  template <typename... Rest>
  void Enqueue(opencl::Queue& queue, const opencl::WorkSize& size,
               std::span<const GrayImage* const> frames, const Rest&... rest) const {
    EnqueueSlots(std::make_index_sequence<kSlots>(), queue, size, frames, rest...);
  }

 private:
  template <std::size_t... kIndex>
  static auto KernelOf(std::index_sequence<kIndex...>)
      -> opencl::Kernel<std::enable_if_t<(kIndex < kSlots), GlobalMemory>..., cl_int, cl_int,
                        GlobalMemory, cl_int, cl_int, cl_int, cl_int>;

  template <std::size_t... kIndex, typename... Rest>
  void EnqueueSlots(std::index_sequence<kIndex...>, opencl::Queue& queue,
                    const opencl::WorkSize& size, std::span<const GrayImage* const> frames,
                    const Rest&... rest) const {
    kernel_.Enqueue(queue, size, *frames[kIndex < frames.size() ? kIndex : 0]..., rest...);
  }

  decltype(KernelOf(std::make_index_sequence<kSlots>())) kernel_;
};

class TemporalMedianOpenCl : public TemporalMedian {
 public:
  TemporalMedianOpenCl(opencl::Context& context, const opencl::RowLayout& layout)
      : context_(context.shared_from_this()),
        layout_(layout),
        queue_(context),
        few_(Compile(32)),
        many_(Compile(96)),
        stacked_(Compile(0), "TemporalMedian"),
        stack_frame_(Compile(0), "StackFrame") {}

  void Run(std::span<const GrayImage* const> frames, int min_samples, GrayImage& median) override {
    min_samples = CheckTemporalMedian(frames, min_samples, median);
    const int count = static_cast<int>(frames.size());
    if (min_samples > count) {
      const auto out = median.Write();
      std::memset(out.data(), 0, out.stride() * out.height());
      return;
    }
    const int groups = (median.width() + layout_.byte_lanes - 1) / layout_.byte_lanes;
    const opencl::WorkSize size = layout_.Size(groups, median.height());
    const auto stride = static_cast<cl_int>(frames[0]->stride());
    bool same_stride = true;
    for (const GrayImage* frame : frames) same_stride &= frame->stride() == stride;
    const auto median_stride = static_cast<cl_int>(median.stride());
    if (same_stride && count <= 32) {
      few_.Enqueue(queue_, size, frames, count, min_samples, median, median.width(),
                   median.height(), stride, median_stride);
    } else if (same_stride && count <= 96) {
      many_.Enqueue(queue_, size, frames, count, min_samples, median, median.width(),
                    median.height(), stride, median_stride);
    } else {
      const cl_ulong pitch = Stack(frames);
      stacked_.Enqueue(queue_, size, *stack_, pitch, count, min_samples, median, median.width(),
                       median.height(), StackStride(median), median_stride);
    }
    queue_.Finish();
  }

 private:
  static cl_int StackStride(const GrayImage& image) {
    return static_cast<cl_int>(opencl::RoundUp(image.width(), 64));
  }

  // Puts all frames into one buffer; returns the bytes from one to the next.
  cl_ulong Stack(std::span<const GrayImage* const> frames) {
    const cl_int stride = StackStride(*frames[0]);
    const std::size_t height = frames[0]->height();
    const cl_ulong pitch = stride * height;
    if (!stack_ || stack_->size_bytes() < pitch * frames.size()) {
      stack_ = context_->Allocate(pitch * frames.size());
    }
    const opencl::WorkSize size = {.global = {static_cast<std::size_t>(stride / 16), height, 1},
                                   .local = {static_cast<std::size_t>(4), 1, 1}};
    for (std::size_t i = 0; i < frames.size(); ++i) {
      stack_frame_.Enqueue(queue_, size, *frames[i], static_cast<cl_int>(frames[i]->stride()),
                           *stack_, i * pitch, stride, static_cast<cl_int>(height));
    }
    return pitch;
  }

  opencl::Program Compile(int slots) const {
    return opencl::CompileForByteLanes(*context_, kTemporalMedianCl,
                                       "-DSLOTS=" + std::to_string(slots), layout_.byte_lanes);
  }

  const std::shared_ptr<opencl::Context> context_;
  const opencl::RowLayout layout_;
  opencl::Queue queue_;
  MedianOfSlots<32> few_;
  MedianOfSlots<96> many_;
  opencl::Kernel<GlobalMemory, cl_ulong, cl_int, cl_int, GlobalMemory, cl_int, cl_int, cl_int,
                 cl_int>
      stacked_;
  opencl::Kernel<GlobalMemory, cl_int, GlobalMemory, cl_ulong, cl_int, cl_int> stack_frame_;
  std::unique_ptr<opencl::Buffer> stack_;
};

}  // namespace

std::unique_ptr<TemporalMedian> MakeTemporalMedianOpenCl(opencl::Context& context,
                                                         const opencl::RowLayout& layout) {
  return std::make_unique<TemporalMedianOpenCl>(context, layout);
}

}  // namespace windhover
