// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/decimate/decimate_cpu.h"

#include <cstdint>
#include <vector>

#include "gpu-kernels/decimate/decimate_check.h"
#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

// sums[x] (+)= row[x]. 16 rows of 255 fit 16 bits.
WINDHOVER_MULTIVERSION
void StartSums(const std::uint8_t* row, int width, std::uint16_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] = row[x];
}

WINDHOVER_MULTIVERSION
void AddToSums(const std::uint8_t* row, int width, std::uint16_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] = static_cast<std::uint16_t>(sums[x] + row[x]);
}

// The rounded mean as a multiplication: (sum + half) * ceil(2^24 / area) >> 24 equals
// (sum + half) / area for all sums of at most 256 pixels, and fits 32 bits.
template <int kFactor>
inline void BlockMeans(const std::uint16_t* sums, int factor, int width, std::uint8_t* out) {
  const int step = kFactor > 0 ? kFactor : factor;
  const std::uint32_t area = step * step;
  const std::uint32_t reciprocal = ((1U << 24) + area - 1) / area;
  for (int x = 0; x < width; ++x) {
    std::uint32_t sum = area / 2;
    for (int i = 0; i < step; ++i) sum += sums[x * step + i];
    out[x] = static_cast<std::uint8_t>((sum * reciprocal) >> 24);
  }
}

WINDHOVER_MULTIVERSION
void BlockMeansOfRow(const std::uint16_t* sums, int factor, int width, std::uint8_t* out) {
  switch (factor) {
    case 1:
      return BlockMeans<1>(sums, factor, width, out);
    case 2:
      return BlockMeans<2>(sums, factor, width, out);
    case 3:
      return BlockMeans<3>(sums, factor, width, out);
    case 4:
      return BlockMeans<4>(sums, factor, width, out);
    default:
      return BlockMeans<0>(sums, factor, width, out);
  }
}

class DecimateCpu : public Decimate {
 public:
  void Run(const GrayImage& source, int factor, GrayImage& destination) override {
    CheckDecimate(source, factor, destination);
    const auto in = source.Read();
    const auto out = destination.Write();
    const int used_width = out.width() * factor;
    if (sums_.size() < static_cast<std::size_t>(used_width)) sums_.resize(used_width);
    for (int y = 0; y < out.height(); ++y) {
      StartSums(in.row(y * factor), used_width, sums_.data());
      for (int i = 1; i < factor; ++i) {
        AddToSums(in.row(y * factor + i), used_width, sums_.data());
      }
      BlockMeansOfRow(sums_.data(), factor, out.width(), out.row(y));
    }
  }

 private:
  std::vector<std::uint16_t> sums_;
};

}  // namespace

std::unique_ptr<Decimate> MakeDecimateCpu() { return std::make_unique<DecimateCpu>(); }

}  // namespace windhover
