// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/temporal_median/temporal_median_cpu.h"

#include <cstdint>
#include <cstring>
#include <vector>

#include "gpu-kernels/multiversion.h"
#include "gpu-kernels/temporal_median/temporal_median_check.h"

namespace windhover {
namespace {

// Pixels that are searched at once; rows are padded to a multiple of it.
constexpr int kBlock = 64;
using Bytes = std::uint8_t __attribute__((vector_size(kBlock), may_alias));

// The lower median of the n values of a pixel that are not 0 is the largest m that at least
// n / 2 + 1 of them reach, found bit by bit from the highest. No value is sorted, and n may differ
// from pixel to pixel. A block of all frames is first gathered: frames whose size is a multiple of
// 4096 bytes would otherwise evict one another from the first level cache in each of the 8 steps.
WINDHOVER_MULTIVERSION
void MedianRow(const std::uint8_t* const* rows, int count, int min_samples, int width,
               std::uint8_t* out) {
  Bytes values[kMaxMedianFrames];
  for (int x = 0; x < width; x += kBlock) {
    Bytes seen = {};
    for (int i = 0; i < count; ++i) {
      values[i] = *reinterpret_cast<const Bytes*>(rows[i] + x);
      seen -= reinterpret_cast<Bytes>(values[i] != 0);
    }
    const Bytes needed = seen / 2 + 1;
    Bytes median = {};
    for (int bit = 128; bit > 0; bit >>= 1) {
      const Bytes candidate = median | static_cast<std::uint8_t>(bit);
      Bytes reached = {};
      for (int i = 0; i < count; ++i) reached -= reinterpret_cast<Bytes>(values[i] >= candidate);
      median = reached >= needed ? candidate : median;
    }
    const Bytes enough = reinterpret_cast<Bytes>(seen >= static_cast<std::uint8_t>(min_samples));
    *reinterpret_cast<Bytes*>(out + x) = median & enough;
  }
}

class TemporalMedianCpu : public TemporalMedian {
 public:
  void Run(std::span<const GrayImage* const> frames, int min_samples, GrayImage& median) override {
    min_samples = CheckTemporalMedian(frames, min_samples, median);
    const int count = static_cast<int>(frames.size());
    if (min_samples > count) {
      const auto out = median.Write();
      std::memset(out.data(), 0, out.stride() * out.height());
      return;
    }
    mapped_.clear();
    for (const GrayImage* frame : frames) mapped_.push_back(frame->Read());
    rows_.resize(count);
    {
      const auto out = median.Write();
      for (int y = 0; y < out.height(); ++y) {
        for (int i = 0; i < count; ++i) rows_[i] = mapped_[i].row(y);
        MedianRow(rows_.data(), count, min_samples, out.width(), out.row(y));
      }
    }
    mapped_.clear();
  }

 private:
  std::vector<MappedImage<const std::uint8_t>> mapped_;
  std::vector<const std::uint8_t*> rows_;
};

}  // namespace

std::unique_ptr<TemporalMedian> MakeTemporalMedianCpu() {
  return std::make_unique<TemporalMedianCpu>();
}

}  // namespace windhover
