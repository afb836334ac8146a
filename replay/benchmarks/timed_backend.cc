// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/timed_backend.h"

#include <string>
#include <utility>

#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/difference_threshold/difference_threshold.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "gpu-kernels/temporal_median/temporal_median.h"
#include "gpu-kernels/warp/warp.h"
#include "replay/benchmarks/timing.h"

namespace windhover::replay {
namespace {

template <typename Run>
void Time(const StageObserver& observe, const std::string& stage, const Run& run) {
  const Clock::time_point start = Clock::now();
  run();
  observe(stage, Milliseconds(Clock::now() - start));
}

// What all of them have: the operator that does the work, and who is told.
template <typename Operator>
class Timed : public Operator {
 public:
  Timed(std::unique_ptr<Operator> inner, StageObserver observe)
      : inner_(std::move(inner)), observe_(std::move(observe)) {}

 protected:
  const std::unique_ptr<Operator> inner_;
  const StageObserver observe_;
};

class TimedDecimate : public Timed<Decimate> {
 public:
  using Timed::Timed;
  void Run(const GrayImage& source, int factor, GrayImage& destination) override {
    Time(observe_, "decimate", [&] { inner_->Run(source, factor, destination); });
  }
};

class TimedDifferenceThreshold : public Timed<DifferenceThreshold> {
 public:
  using Timed::Timed;
  void Run(const GrayImage& frame, const GrayImage& background,
           const DifferenceThresholdSettings& settings, BitImage& seeds) override {
    Time(observe_, "difference threshold",
         [&] { inner_->Run(frame, background, settings, seeds); });
  }
};

class TimedTemporalMedian : public Timed<TemporalMedian> {
 public:
  using Timed::Timed;
  void Run(std::span<const GrayImage* const> frames, int min_samples, GrayImage& median) override {
    Time(observe_, "temporal median", [&] { inner_->Run(frames, min_samples, median); });
  }
};

class TimedWarp : public Timed<Warp> {
 public:
  using Timed::Timed;
  void Run(const GrayImage& source, const Matrix3& source_from_destination,
           GrayImage& destination) override {
    Time(observe_, "warp", [&] { inner_->Run(source, source_from_destination, destination); });
  }
};

class TimedPhaseCorrelation : public Timed<PhaseCorrelation> {
 public:
  TimedPhaseCorrelation(std::unique_ptr<PhaseCorrelation> inner, const StageObserver& observe)
      : Timed(std::move(inner), observe) {
    const PhaseCorrelationSettings& s = settings();
    const std::string tiles = std::to_string(s.tiles.size()) + " x " +
                              std::to_string(s.tile_width) + "x" + std::to_string(s.tile_height);
    transform_ = "transform " + tiles;
    correlate_ = "correlate " + tiles;
  }

  const PhaseCorrelationSettings& settings() const override { return inner_->settings(); }
  std::unique_ptr<TileSpectra> MakeSpectra() const override { return inner_->MakeSpectra(); }
  void Transform(const GrayImage& picture, const Matrix3& picture_from_grid,
                 TileSpectra& spectra) override {
    Time(observe_, transform_, [&] { inner_->Transform(picture, picture_from_grid, spectra); });
  }
  void Correlate(const TileSpectra& reference, const TileSpectra& current,
                 std::span<TilePeak> peaks) override {
    Time(observe_, correlate_, [&] { inner_->Correlate(reference, current, peaks); });
  }

 private:
  std::string transform_;
  std::string correlate_;
};

class TimedBackend : public Backend {
 public:
  TimedBackend(std::shared_ptr<Backend> inner, StageObserver observe)
      : inner_(std::move(inner)), observe_(std::move(observe)) {}

  const DeviceInfo& device() const override { return inner_->device(); }
  std::unique_ptr<Memory> Allocate(std::size_t size_bytes) override {
    return inner_->Allocate(size_bytes);
  }
  std::unique_ptr<Decimate> MakeDecimate() override {
    return std::make_unique<TimedDecimate>(inner_->MakeDecimate(), observe_);
  }
  std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() override {
    return std::make_unique<TimedDifferenceThreshold>(inner_->MakeDifferenceThreshold(), observe_);
  }
  std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(
      const PhaseCorrelationSettings& settings) override {
    return std::make_unique<TimedPhaseCorrelation>(inner_->MakePhaseCorrelation(settings),
                                                   observe_);
  }
  std::unique_ptr<TemporalMedian> MakeTemporalMedian() override {
    return std::make_unique<TimedTemporalMedian>(inner_->MakeTemporalMedian(), observe_);
  }
  std::unique_ptr<Warp> MakeWarp() override {
    return std::make_unique<TimedWarp>(inner_->MakeWarp(), observe_);
  }
  void WarmUp(const std::function<void(const std::string&)>& progress) override {
    inner_->WarmUp(progress);
  }

 private:
  const std::shared_ptr<Backend> inner_;
  const StageObserver observe_;
};

}  // namespace

std::shared_ptr<Backend> MakeTimedBackend(std::shared_ptr<Backend> backend,
                                          const StageObserver& observe) {
  return std::make_shared<TimedBackend>(std::move(backend), observe);
}

}  // namespace windhover::replay
