// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/warp/warp_cpu.h"

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "gpu-kernels/multiversion.h"
#include "gpu-kernels/warp/row_sampler_cpu.h"
#include "gpu-kernels/warp/warp_coefficients.h"

namespace windhover {
namespace {

// Rounds grey levels; seen pixels are at least 1, others 0.
WINDHOVER_MULTIVERSION
void Round(const float* values, const float* seen, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const float value = values[x] > seen[x] ? values[x] : seen[x];
    out[x] = static_cast<std::uint8_t>(static_cast<int>(value + 0.5F));
  }
}

class WarpCpu : public Warp {
 public:
  void Run(const GrayImage& source, const Matrix3& source_from_destination,
           GrayImage& destination) override {
    if (source.empty() || destination.empty() || &source == &destination) {
      throw std::invalid_argument("warp: source and destination must be two images");
    }
    const WarpCoefficients coefficients = MakeWarpCoefficients(source_from_destination);
    const auto in = source.Read();
    const auto out = destination.Write();
    values_.resize(out.width());
    seen_.resize(out.width());
    for (int y = 0; y < out.height(); ++y) {
      sampler_.Sample(in, coefficients, y, out.width(), values_.data(), seen_.data());
      Round(values_.data(), seen_.data(), out.width(), out.row(y));
    }
  }

 private:
  RowSampler sampler_;
  std::vector<float> values_;
  std::vector<float> seen_;
};

}  // namespace

std::unique_ptr<Warp> MakeWarpCpu() { return std::make_unique<WarpCpu>(); }

}  // namespace windhover
