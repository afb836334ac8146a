// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/speed_contestants.h"

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>

#include "gpu-kernels/backend.h"
#include "replay/baselines/klt_registration.h"
#include "replay/benchmarks/registration_results.h"
#include "replay/benchmarks/timing.h"
#include "replay/offline/frame_outcome.h"
#include "replay/offline/pipeline_run.h"
#include "replay/offline/product_registration.h"

namespace windhover::replay {
namespace {

// Short queues: a frame that waits in one was registered before it is counted.
constexpr const char* kPipeline =
    "whregister ! queue max-size-buffers=2 max-size-bytes=0 max-size-time=0 ! whbackground ! "
    "queue max-size-buffers=2 max-size-bytes=0 max-size-time=0 ! whmotion";
// No frame takes so long.
constexpr auto kStandstill = std::chrono::seconds(60);

class PeerContestant : public SpeedContestant {
 public:
  using Make = std::function<std::unique_ptr<RegistrationPeer>(int width, int height)>;

  PeerContestant(std::string title, std::string what, std::vector<std::string> variants, Make make)
      : SpeedContestant(std::move(title), std::move(what), std::move(variants)),
        make_(std::move(make)) {}

 private:
  void Run(const SpeedFlight& flight) override {
    const std::unique_ptr<RegistrationPeer> registration = make_(flight.width, flight.height);
    for (std::size_t i = 0; i < flight.i420.size(); ++i) {
      const cv::Mat luma = flight.Luma(i);
      const Clock::time_point start = Clock::now();
      const std::optional<Eigen::Matrix3d> found = registration->Register(luma);
      const double taken = Milliseconds(Clock::now() - start);
      if (i < kRegistrationWarmUp) continue;
      AddTime(taken);
      Score(flight, i, found);
    }
  }

  Make make_;
};

class PipelineContestant : public SpeedContestant {
 public:
  PipelineContestant(std::string title, std::string what, std::vector<std::string> variants,
                     const PipelineContestantSettings& settings)
      : SpeedContestant(std::move(title), std::move(what), std::move(variants)),
        settings_(settings) {}

 private:
  void Run(const SpeedFlight& flight) override {
    const std::size_t count =
        std::min(static_cast<std::size_t>(settings_.frames), flight.i420.size());
    const std::vector<cv::Mat> frames(flight.i420.begin(),
                                      flight.i420.begin() + static_cast<std::ptrdiff_t>(count));
    entered_.clear();
    left_.clear();
    outcomes_.clear();
    PlayThroughPipeline(
        frames, flight.frame_rate_hz,
        {kPipeline, {{"device", settings_.device}, {"reference", settings_.reference}}},
        [this](GstBuffer* buffer) { Leave(buffer); }, [this](std::size_t frame) { Enter(frame); });
    if (left_.size() != count) {
      throw std::runtime_error(std::to_string(count) + " frames went into the pipeline, " +
                               std::to_string(left_.size()) + " came out");
    }
    TimeFrames();
    ScoreFrames(flight);
  }

  void Enter(std::size_t frame) {
    std::unique_lock lock(mutex_);
    const auto others_out = [&] { return left_.size() + kHeldFrames >= frame; };
    if (settings_.one_at_a_time && !leaves_.wait_for(lock, kStandstill, others_out)) {
      throw std::runtime_error("a frame does not leave the pipeline");
    }
    entered_.push_back(Clock::now());
  }

  void Leave(GstBuffer* buffer) {
    {
      const std::scoped_lock lock(mutex_);
      left_.push_back(Clock::now());
    }
    leaves_.notify_one();
    outcomes_.push_back(OutcomeOf(buffer));
  }

  void TimeFrames() {
    const std::size_t last_ones = settings_.one_at_a_time ? kHeldFrames : kFramesOnTheWay;
    for (std::size_t i = kPipelineWarmUp; i + last_ones < left_.size(); ++i) {
      AddTime(Milliseconds(left_[i] -
                           (settings_.one_at_a_time ? entered_[i + kHeldFrames] : left_[i - 1])));
    }
  }

  void ScoreFrames(const SpeedFlight& flight) {
    std::vector<LabelledBox> movers;
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      movers.insert(movers.end(), flight.truth[i].movers.begin(), flight.truth[i].movers.end());
      if (i == 0) continue;
      const FrameRegistration& found = outcomes_[i].registration;
      const bool lost = found.quality == RegistrationQuality::kLost || found.starts_segment;
      Score(flight, i, lost ? std::nullopt : std::optional(found.previous_from_frame));
    }
    Score(ScoreMotion(movers, BoxesOf(outcomes_)));
  }

  PipelineContestantSettings settings_;
  std::mutex mutex_;
  std::condition_variable leaves_;
  std::vector<Clock::time_point> entered_;
  std::vector<Clock::time_point> left_;
  std::vector<FrameOutcome> outcomes_;
};

}  // namespace

void SpeedContestant::RunRound(const std::vector<SpeedFlight>& flights) {
  const std::size_t before = times_ms_.size();
  for (const SpeedFlight& flight : flights) Run(flight);
  double taken_ms = 0;
  for (std::size_t i = before; i < times_ms_.size(); ++i) taken_ms += times_ms_[i];
  round_fps_.push_back(1000 * static_cast<double>(times_ms_.size() - before) / taken_ms);
}

std::optional<double> SpeedContestant::rms_px() const {
  if (rms_pairs_ == 0) return std::nullopt;
  return rms_sum_px_ / rms_pairs_;
}

std::optional<double> SpeedContestant::f1() const { return motion_.f1(); }

void SpeedContestant::Score(const SpeedFlight& flight, std::size_t frame,
                            const std::optional<Eigen::Matrix3d>& previous_from_frame) {
  const Eigen::Matrix3d truth =
      flight.truth[frame - 1].first_from_frame.inverse() * flight.truth[frame].first_from_frame;
  const std::optional<double> rms =
      PairRms(previous_from_frame, truth, flight.width, flight.height);
  if (!rms) return;
  rms_sum_px_ += *rms;
  ++rms_pairs_;
}

std::unique_ptr<SpeedContestant> MakeKltContestant() {
  return std::make_unique<PeerContestant>(
      "KLT grid + RANSAC", "peer.klt", std::vector<std::string>{""},
      [](int, int) { return std::make_unique<KltRegistration>(); });
}

std::unique_ptr<SpeedContestant> MakeRegistrationContestant(const std::string& device,
                                                            const std::string& name) {
  return std::make_unique<PeerContestant>(
      "registration, " + name, "registration", std::vector<std::string>{name + "."},
      [backend = std::shared_ptr<Backend>(Backend::Create(device))](int width, int height) {
        return std::make_unique<ProductRegistration>(backend, width, height, RegistrationOptions());
      });
}

std::unique_ptr<SpeedContestant> MakePipelineContestant(
    const std::string& title, const std::string& what, const std::vector<std::string>& variants,
    const PipelineContestantSettings& settings) {
  return std::make_unique<PipelineContestant>(title, what, variants, settings);
}

}  // namespace windhover::replay
