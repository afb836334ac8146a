// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/opencl_backend.h"

#include <memory>
#include <utility>

#include "gpu-kernels/decimate/decimate_opencl.h"
#include "gpu-kernels/difference_threshold/difference_threshold_opencl.h"
#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/phase_correlation/phase_correlation_opencl.h"
#include "gpu-kernels/temporal_median/temporal_median_opencl.h"
#include "gpu-kernels/warp/warp_opencl.h"

namespace windhover::opencl {
namespace {

class OpenClBackend : public Backend {
 public:
  OpenClBackend(const Device& device, ProgramCache cache)
      : context_(std::make_shared<Context>(device, std::move(cache))) {}

  const DeviceInfo& device() const override { return context_->device(); }

  std::unique_ptr<Memory> Allocate(std::size_t size_bytes) override {
    return context_->Allocate(size_bytes);
  }

  std::unique_ptr<Decimate> MakeDecimate() override { return MakeDecimateOpenCl(*context_); }
  std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() override {
    return MakeDifferenceThresholdOpenCl(*context_);
  }
  std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(
      const PhaseCorrelationSettings& settings) override {
    return MakePhaseCorrelationOpenCl(*context_, settings, PhaseCorrelationLayout::For(*context_));
  }
  std::unique_ptr<TemporalMedian> MakeTemporalMedian() override {
    return MakeTemporalMedianOpenCl(*context_);
  }
  std::unique_ptr<Warp> MakeWarp() override { return MakeWarpOpenCl(*context_); }

  void WarmUp(const std::function<void(const std::string&)>& progress) override;

 private:
  std::shared_ptr<Context> context_;
};

void OpenClBackend::WarmUp(const std::function<void(const std::string&)>&) {}

}  // namespace

std::shared_ptr<Backend> MakeOpenClBackend(const Device& device, ProgramCache cache) {
  return std::make_shared<OpenClBackend>(device, std::move(cache));
}

}  // namespace windhover::opencl
