// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/speed_benchmark.h"

#include <Eigen/LU>
#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "gpu-kernels/backend.h"
#include "replay/baselines/klt_registration.h"
#include "replay/benchmarks/timing.h"
#include "replay/offline/pipeline_run.h"
#include "replay/offline/product_registration.h"
#include "replay/render/parallel.h"
#include "replay/render/renderer.h"
#include "replay/scoring/registration_score.h"
#include "service/gstreamer/start.h"

namespace windhover::replay {
namespace {

constexpr int kRegistrationWarmUp = 10;
constexpr int kPipelineWarmUp = 42;  // twice the window of 2k + 1 frames at k = 10
// Short queues: a frame that waits in one was registered before it is counted.
constexpr const char* kPipeline =
    "whregister ! queue max-size-buffers=2 max-size-bytes=0 max-size-time=0 ! whbackground ! "
    "queue max-size-buffers=2 max-size-bytes=0 max-size-time=0 ! whmotion";
// Frames that can be on the way: k = 10 held for their future, two in each queue, one in each
// element's hands. The last ones are not counted, so that as many are on the way when the count
// ends as when it starts, and each stage does the work of as many frames as are counted.
constexpr std::size_t kOnTheWay = 10 + 2 * 2 + 3;

struct Flight {
  std::vector<cv::Mat> gray;  // CV_8UC1
  std::vector<cv::Mat> i420;
  std::vector<Eigen::Matrix3d> first_from_frame;
  int width = 0;
  int height = 0;
};

Flight RenderFlight(const SpeedBenchmarkSettings& settings) {
  const Renderer renderer(settings.plan, settings.threads);
  Flight flight;
  const int frames = settings.plan.frames;
  flight.gray.resize(frames);
  flight.i420.resize(frames);
  flight.first_from_frame.resize(frames);
  flight.width = settings.plan.width;
  flight.height = settings.plan.height;
  ForEachInParallel(frames, settings.threads, [&](int i) {
    const cv::Mat frame = renderer.Frame(i);
    cv::cvtColor(frame, flight.gray[i], cv::COLOR_BGR2GRAY);
    cv::cvtColor(frame, flight.i420[i], cv::COLOR_BGR2YUV_I420);
    flight.first_from_frame[i] = renderer.TrueHomography(i);
  });
  return flight;
}

class Contestant {
 public:
  Contestant(std::string name, std::string figure) : figure_(std::move(figure)) {
    result_.name = std::move(name);
  }
  virtual ~Contestant() = default;

  void RunRound(const Flight& flight) {
    const std::size_t before = times_ms_.size();
    TimeFrames(flight);
    double taken_ms = 0;
    for (std::size_t i = before; i < times_ms_.size(); ++i) taken_ms += times_ms_[i];
    round_fps_.push_back(1000 * static_cast<double>(times_ms_.size() - before) / taken_ms);
  }

  SpeedContestant Result() const {
    SpeedContestant result = result_;
    result.median_ms = Quantile(times_ms_, 0.5);
    result.p95_ms = Quantile(times_ms_, 0.95);
    result.frames = static_cast<int>(times_ms_.size());
    result.fps = Quantile(round_fps_, 0.5);
    result.rms_px = rms_pairs_ > 0 ? rms_sum_ / rms_pairs_ : 0;
    return result;
  }
  const std::string& figure() const { return figure_; }

 protected:
  // Appends the time of each frame that counts to times_ms_.
  virtual void TimeFrames(const Flight& flight) = 0;

  // Registers all frames with `one`, which returns previous_from_frame, one after the other.
  template <typename RegisterOne>
  void TimeRegistration(const Flight& flight, RegisterOne&& one) {
    for (std::size_t i = 0; i < flight.gray.size(); ++i) {
      const Clock::time_point start = Clock::now();
      const Eigen::Matrix3d previous_from_frame = one(flight.gray[i]);
      const double taken = Milliseconds(Clock::now() - start);
      if (i < kRegistrationWarmUp) continue;
      times_ms_.push_back(taken);
      const Eigen::Matrix3d truth =
          flight.first_from_frame[i - 1].inverse() * flight.first_from_frame[i];
      const std::optional<double> rms =
          RegistrationRms(previous_from_frame, truth, flight.width, flight.height);
      if (!rms) continue;
      rms_sum_ += *rms;
      ++rms_pairs_;
    }
  }

  std::vector<double> times_ms_;

 private:
  std::string figure_;
  SpeedContestant result_;
  std::vector<double> round_fps_;
  double rms_sum_ = 0;
  int rms_pairs_ = 0;
};

class RegistrationContestant : public Contestant {
 public:
  RegistrationContestant(std::string name, std::string figure, const std::string& device,
                         ReferenceMode mode)
      : Contestant(std::move(name), std::move(figure)), backend_(Backend::Create(device)) {
    options_.reference = mode;
  }

  void TimeFrames(const Flight& flight) override {
    ProductRegistration registration(backend_, flight.width, flight.height, options_);
    TimeRegistration(flight, [&](const cv::Mat& gray) {
      registration.Register(gray);
      return registration.last().previous_from_frame;
    });
  }

 private:
  std::shared_ptr<Backend> backend_;
  RegistrationOptions options_;
};

class KltContestant : public Contestant {
 public:
  KltContestant() : Contestant("KLT grid + RANSAC", "peer.klt.fps") {}
  void TimeFrames(const Flight& flight) override {
    KltRegistration klt;
    TimeRegistration(flight, [&](const cv::Mat& gray) {
      return klt.Register(gray).value_or(Eigen::Matrix3d::Identity());
    });
  }
};

// The time of a frame is the time from its predecessor's leaving the pipeline to its own.
class PipelineContestant : public Contestant {
 public:
  PipelineContestant(std::string name, std::string figure, const std::string& device,
                     const std::string& mode, double frame_rate_hz, std::size_t frames)
      : Contestant(std::move(name), std::move(figure)),
        settings_{kPipeline, {{"device", device}, {"reference", mode}}},
        frame_rate_hz_(frame_rate_hz),
        frames_(frames) {}

  void TimeFrames(const Flight& flight) override {
    const std::vector<cv::Mat> played(
        flight.i420.begin(),
        flight.i420.begin() + static_cast<std::ptrdiff_t>(std::min(frames_, flight.i420.size())));
    std::vector<Clock::time_point> left;
    left.reserve(played.size());
    PlayThroughPipeline(played, frame_rate_hz_, settings_,
                        [&left](GstBuffer*) { left.push_back(Clock::now()); });
    if (left.size() != played.size()) {
      throw std::runtime_error(std::to_string(played.size()) + " frames went into the pipeline, " +
                               std::to_string(left.size()) + " came out");
    }
    for (std::size_t i = kPipelineWarmUp; i + kOnTheWay < left.size(); ++i) {
      times_ms_.push_back(Milliseconds(left[i] - left[i - 1]));
    }
  }

 private:
  PipelineSettings settings_;
  double frame_rate_hz_;
  std::size_t frames_;
};

std::vector<std::unique_ptr<Contestant>> MakeContestants(const SpeedBenchmarkSettings& settings,
                                                         const std::string& opencl) {
  std::vector<std::unique_ptr<Contestant>> contestants;
  contestants.push_back(std::make_unique<KltContestant>());
  struct Device {
    const char* name;
    const char* figure;
    std::string selector;
  };
  std::vector<Device> devices = {{"CPU twin", "cpu.", "cpu"}};
  if (!opencl.empty()) devices.push_back({"OpenCL", "opencl.", opencl});
  for (const Device& device : devices) {
    for (const ReferenceMode mode : {ReferenceMode::kAnchor, ReferenceMode::kCentre}) {
      const bool anchor = mode == ReferenceMode::kAnchor;
      const std::string text = anchor ? "anchor" : "centre";
      const std::string suffix = (anchor ? "" : ".centre");
      contestants.push_back(std::make_unique<RegistrationContestant>(
          "registration " + text + ", " + device.name,
          "registration.fps" + suffix + "." + device.figure, device.selector, mode));
      contestants.push_back(std::make_unique<PipelineContestant>(
          "pipeline " + text + ", " + device.name, "pipeline.fps" + suffix + "." + device.figure,
          device.selector, text, settings.plan.frame_rate_hz,
          static_cast<std::size_t>(anchor ? settings.plan.frames : settings.centre_frames)));
    }
  }
  return contestants;
}

// The device that is used by default where that is an OpenCL device, else the best one; the CPU
// twin where there is none.
DeviceInfo OpenClDevice(const DeviceInfo& by_default) {
  if (by_default.kind != DeviceKind::kCpuTwin) return by_default;
  for (const DeviceInfo& device : Backend::Devices()) {
    if (device.kind != DeviceKind::kCpuTwin) return device;
  }
  return by_default;
}

}  // namespace

SpeedBenchmarkResult RunSpeedBenchmark(const SpeedBenchmarkSettings& settings,
                                       const std::function<void(const std::string&)>& say) {
  if (std::min(settings.plan.frames, settings.centre_frames) < 2 * kPipelineWarmUp) {
    throw std::invalid_argument("the benchmark needs at least " +
                                std::to_string(2 * kPipelineWarmUp) + " frames");
  }
  if (settings.plan.width % 2 != 0 || settings.plan.height % 2 != 0) {
    throw std::invalid_argument("the benchmark needs even frame sizes");
  }
  StartGStreamer();
  SpeedBenchmarkResult result;
  result.plugin_file = PluginFile();
  const DeviceInfo by_default = Backend::Create()->device();
  result.default_device = by_default.Describe();
  say("rendering " + std::to_string(settings.plan.frames) + " frames");
  const Flight flight = RenderFlight(settings);
  const DeviceInfo opencl = OpenClDevice(by_default);
  const bool has_opencl = opencl.kind != DeviceKind::kCpuTwin;
  const std::vector<std::unique_ptr<Contestant>> contestants =
      MakeContestants(settings, has_opencl ? opencl.selector : "");
  for (int round = 1; round <= settings.rounds; ++round) {
    for (const std::unique_ptr<Contestant>& contestant : contestants) {
      say("round " + std::to_string(round) + ": " + contestant->Result().name);
      contestant->RunRound(flight);
    }
  }
  if (has_opencl) result.opencl_device = opencl.Describe();
  const std::string size = std::to_string(flight.width) + "x" + std::to_string(flight.height);
  double klt_fps = 0;
  double default_registration_fps = 0;
  for (const std::unique_ptr<Contestant>& contestant : contestants) {
    const SpeedContestant one = contestant->Result();
    result.contestants.push_back(one);
    const std::string& figure = contestant->figure();
    if (figure == "peer.klt.fps") {
      klt_fps = one.fps;
      result.figures.push_back({"peer.klt.fps." + size, one.fps, "1/s"});
      continue;
    }
    result.figures.push_back({figure + size, one.fps, "1/s"});
    // The figures of the device that is used by default stand without its name.
    const std::string used = by_default.kind == DeviceKind::kCpuTwin ? ".cpu." : ".opencl.";
    if (figure == "registration.fps" + used) default_registration_fps = one.fps;
    if (figure == "pipeline.fps" + used) {
      result.figures.push_back({"pipeline.fps." + size, one.fps, "1/s"});
    }
    if (figure == "pipeline.fps.centre" + used) {
      result.figures.push_back({"pipeline.fps.centre." + size, one.fps, "1/s"});
    }
  }
  result.figures.push_back(
      {"registration.speed_ratio_to_klt", default_registration_fps / klt_fps, ""});
  return result;
}

}  // namespace windhover::replay
