// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/stage_benchmark.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "replay/benchmarks/speed_contestants.h"
#include "replay/benchmarks/speed_setup.h"
#include "replay/benchmarks/stage_log.h"
#include "replay/benchmarks/timed_backend.h"
#include "replay/benchmarks/timing.h"
#include "service/vision/background.h"
#include "service/vision/motion.h"
#include "service/vision/registration.h"

namespace windhover::replay {
namespace {

using Level = StageLog::Level;

// The service over one flight, without elements and threads about it.
class StagedRun {
 public:
  StagedRun(const std::string& device, const SpeedFlight& flight)
      : flight_(flight),
        backend_(MakeTimedBackend(Backend::Create(device, {}, Into(Level::kDevice)),
                                  Into(Level::kOperator))),
        frame_(backend_->MakeImage<std::uint8_t>(flight.width, flight.height)),
        registration_(backend_, flight.width, flight.height, {}),
        background_(backend_, flight.width, flight.height, {}, {}),
        motion_({}) {}

  StageLog Run(const BenchmarkProgress& progress) {
    for (std::size_t i = 0; i < flight_.i420.size(); ++i) {
      progress.check();
      if (i == kPipelineWarmUp) log_ = {};
      RunFrame(i);
      log_.EndFrame();
    }
    return log_;
  }

 private:
  StageObserver Into(Level level) {
    return [this, level](const std::string& stage, double ms) { log_.Add(level, stage, ms); };
  }

  template <typename Step>
  auto Time(const std::string& stage, const Step& step) {
    const Clock::time_point start = Clock::now();
    auto result = step();
    log_.Add(Level::kService, stage, Milliseconds(Clock::now() - start));
    return result;
  }

  void RunFrame(std::size_t i) {
    const cv::Mat luma = flight_.Luma(i);
    {
      const MappedImage<std::uint8_t> pixels = frame_.Write();
      for (int y = 0; y < luma.rows; ++y) std::copy_n(luma.ptr(y), luma.cols, pixels.row(y));
    }
    const FrameRegistration registered =
        Time("registration", [&] { return registration_.Register(frame_); });
    std::shared_ptr<const MotionEvidence> evidence = Time("background", [&] {
      background_.Push(frame_, registered);
      return background_.Pop();
    });
    while (evidence) {
      Time("motion", [&] { return motion_.Detect(*evidence).size(); });
      evidence = Time("background", [&] { return background_.Pop(); });
    }
  }

  StageLog log_;
  const SpeedFlight& flight_;
  const std::shared_ptr<Backend> backend_;
  GrayImage frame_;
  StreamRegistration registration_;
  BackgroundSubtraction background_;
  MotionDetection motion_;
};

}  // namespace

BenchmarkDocument RunStageBenchmark(const SpeedBenchmarkSettings& settings,
                                    const BenchmarkProgress& progress) {
  Check(settings);
  BenchmarkDocument document;
  const SpeedDevices devices = DevicesToTime();
  document.device = devices.by_default;
  document.left_out = devices.left_out;
  const std::string sequence = settings.sequences.at(0);
  document.options = {{"sequence", sequence}, {"opencl", devices.opencl}};
  for (const SpeedSize& size : settings.sizes) {
    const SpeedFlight flight = RenderSpeedFlight(sequence, size, settings.threads, progress);
    for (const SpeedDevice& device : devices.devices) {
      progress.say(SizeText(size) + ": " + device.name);
      document.tables.push_back({.name = "stages." + device.name + "." + SizeText(size),
                                 .title = SizeText(size) + ", " + device.name + ", " +
                                          std::to_string(size.frames - kPipelineWarmUp) + " frames",
                                 .columns = StageLog::Columns(),
                                 .rows = StagedRun(device.selector, flight).Run(progress).Rows(),
                                 .digits = 3});
    }
  }
  return document;
}

}  // namespace windhover::replay
