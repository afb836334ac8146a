// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/opencl_backend.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gpu-kernels/decimate/decimate_check.h"
#include "gpu-kernels/decimate/decimate_opencl.h"
#include "gpu-kernels/difference_threshold/difference_threshold_opencl.h"
#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/opencl/row_layout.h"
#include "gpu-kernels/phase_correlation/phase_correlation_opencl.h"
#include "gpu-kernels/temporal_median/temporal_median_opencl.h"
#include "gpu-kernels/warp/warp_opencl.h"

namespace windhover::opencl {
namespace {

// The whole ranges of what the operators take; of the windows, one for each kind of median kernel.
constexpr int kTransformSides[] = {16, 32, 64, 128, 256, 512};
constexpr std::size_t kMedianWindows[] = {21, 81, 255};

class OpenClBackend : public Backend {
 public:
  OpenClBackend(const Device& device, ProgramCache cache, const StageObserver& observe)
      : context_(std::make_shared<Context>(device, std::move(cache), observe)) {}

  const DeviceInfo& device() const override { return context_->device(); }

  std::unique_ptr<Memory> Allocate(std::size_t size_bytes) override {
    return context_->Allocate(size_bytes);
  }

  std::unique_ptr<Decimate> MakeDecimate() override {
    return MakeDecimateOpenCl(*context_, layout_);
  }
  std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() override {
    return MakeDifferenceThresholdOpenCl(*context_, layout_);
  }
  std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(
      const PhaseCorrelationSettings& settings) override {
    return MakePhaseCorrelationOpenCl(*context_, settings, PhaseCorrelationLayout::For(*context_));
  }
  std::unique_ptr<TemporalMedian> MakeTemporalMedian() override {
    return MakeTemporalMedianOpenCl(*context_, layout_);
  }
  std::unique_ptr<Warp> MakeWarp() override { return MakeWarpOpenCl(*context_, layout_); }

  void WarmUp(const std::function<void(const std::string&)>& progress) override;

 private:
  const std::shared_ptr<Context> context_;
  const RowLayout layout_ = RowLayout::For(*context_);
};

// Runs each operator once, as drivers may put off compiling until then.
void OpenClBackend::WarmUp(const std::function<void(const std::string&)>& progress) {
  const auto announce = [&](const std::string& what) {
    if (progress) progress(what);
  };
  constexpr int kSide = 64;
  const auto make_image = [this] {
    GrayImage image = MakeImage<std::uint8_t>(kSide, kSide);
    const auto mapped = image.Write();
    std::fill_n(mapped.data(), mapped.stride() * kSide, std::uint8_t{1});
    return image;
  };
  const GrayImage source = make_image();
  GrayImage result = make_image();

  announce("decimation");
  const auto decimate = MakeDecimate();
  for (int factor = 1; factor <= kMaxDecimation; ++factor) {
    GrayImage small = MakeImage<std::uint8_t>(kSide / factor, kSide / factor);
    decimate->Run(source, factor, small);
  }
  announce("warp");
  MakeWarp()->Run(source, kIdentity3, result);
  announce("temporal median");
  const auto median = MakeTemporalMedian();
  for (const std::size_t window : kMedianWindows) {
    median->Run(std::vector<const GrayImage*>(window, &source), 1, result);
  }
  announce("difference threshold");
  BitImage seeds = MakeBitImage(kSide, kSide);
  const auto difference = MakeDifferenceThreshold();
  for (const float gain : {0.0F, 1.0F}) {
    difference->Run(source, source, {.threshold = 20, .gradient_gain_px = gain}, seeds);
  }
  for (const int side : kTransformSides) {
    announce("phase correlation of tile sides of " + std::to_string(side) + " px");
    PhaseCorrelationSettings settings;
    settings.tile_width = side;
    settings.tile_height = side;
    settings.tiles = {{}};
    const auto correlation = MakePhaseCorrelation(settings);
    const auto spectra = correlation->MakeSpectra();
    correlation->Transform(source, kIdentity3, *spectra);
    TilePeak peak;
    correlation->Correlate(*spectra, *spectra, {&peak, 1});
  }
  context_->StorePrograms();
}

}  // namespace

std::shared_ptr<Backend> MakeOpenClBackend(const Device& device, ProgramCache cache,
                                           const StageObserver& observe) {
  return std::make_shared<OpenClBackend>(device, std::move(cache), observe);
}

}  // namespace windhover::opencl
