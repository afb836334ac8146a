// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/cpu/cpu_backend.h"

#include <new>
#include <stdexcept>
#include <string>
#include <thread>

#include "gpu-kernels/decimate/decimate_cpu.h"
#include "gpu-kernels/difference_threshold/difference_threshold_cpu.h"
#include "gpu-kernels/phase_correlation/phase_correlation_cpu.h"
#include "gpu-kernels/temporal_median/temporal_median_cpu.h"
#include "gpu-kernels/warp/warp_cpu.h"

namespace windhover {
namespace {

constexpr std::align_val_t kAlignment{64};
// More is a mistake, which sanitized allocators end the program for.
constexpr std::size_t kMaxBytes = std::size_t{1} << 38;

class HostMemory : public Memory {
 public:
  explicit HostMemory(std::size_t size_bytes)
      : bytes_(static_cast<std::byte*>(::operator new(size_bytes, kAlignment))) {}
  HostMemory(const HostMemory&) = delete;
  HostMemory& operator=(const HostMemory&) = delete;
  ~HostMemory() override { ::operator delete(bytes_, kAlignment); }

  std::byte* Map(Access) override { return bytes_; }
  void Unmap(std::byte*) noexcept override {}

 private:
  std::byte* bytes_;
};

class CpuBackend : public Backend {
 public:
  const DeviceInfo& device() const override { return device_; }

  std::unique_ptr<Memory> Allocate(std::size_t size_bytes) override {
    if (size_bytes == 0) throw std::invalid_argument("memory of 0 bytes asked for");
    try {
      if (size_bytes > kMaxBytes) throw std::bad_alloc();
      return std::make_unique<HostMemory>(size_bytes);
    } catch (const std::bad_alloc&) {
      throw DeviceError("CPU twin: no memory for " + std::to_string(size_bytes) + " bytes");
    }
  }

  std::unique_ptr<Decimate> MakeDecimate() override { return MakeDecimateCpu(); }
  std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() override {
    return MakeDifferenceThresholdCpu();
  }
  std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(
      const PhaseCorrelationSettings& settings) override {
    return MakePhaseCorrelationCpu(settings);
  }
  std::unique_ptr<TemporalMedian> MakeTemporalMedian() override { return MakeTemporalMedianCpu(); }
  std::unique_ptr<Warp> MakeWarp() override { return MakeWarpCpu(); }

  void WarmUp(const std::function<void(const std::string&)>&) override {}

 private:
  const DeviceInfo device_ = CpuTwinInfo();
};

}  // namespace

DeviceInfo CpuTwinInfo() {
  DeviceInfo info;
  info.kind = DeviceKind::kCpuTwin;
  info.name = "CPU twin";
  info.selector = "cpu";
  info.compute_units = static_cast<int>(std::thread::hardware_concurrency());
  return info;
}

std::shared_ptr<Backend> MakeCpuBackend() { return std::make_shared<CpuBackend>(); }

}  // namespace windhover
