// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "replay/baselines/registration_peer.h"
#include "replay/render/renderer.h"
#include "replay/scoring/motion_score.h"
#include "service/options/options.h"

namespace windhover::replay {

// A flight in memory.
struct SpeedFlight {
  int width = 0;
  int height = 0;
  double frame_rate_hz = 0;
  std::vector<cv::Mat> i420;  // as cv::cvtColor makes it
  std::vector<FrameTruth> truth;

  // CV_8UC1, a view.
  cv::Mat Luma(std::size_t frame) const { return i420[frame].rowRange(0, height); }
};

// Frames that whbackground holds for their future.
inline constexpr int kHeldFrames = std::min(BackgroundOptions().lookahead, BackgroundOptions().k);
// The first frames of a run, which are not counted: of registration, and of those that leave a
// pipeline, whose window of 2k + 1 frames is full then.
inline constexpr int kRegistrationWarmUp = 10;
inline constexpr int kPipelineWarmUp = 2 * BackgroundOptions().k + 4;
// Frames that can be on the way: those, two in each queue, one in each element's hands. The last
// ones are not counted, so that as many are on the way when the count ends as when it starts, and
// each stage does the work of as many frames as are counted.
inline constexpr int kFramesOnTheWay = kHeldFrames + 2 * 2 + 3;

// Something whose frames are timed.
class SpeedContestant {
 public:
  // "registration", then what it is of: "cpu." or "" and so on, more than one where it stands for
  // several figures.
  SpeedContestant(std::string title, std::string what, std::vector<std::string> variants)
      : title_(std::move(title)), what_(std::move(what)), variants_(std::move(variants)) {}
  virtual ~SpeedContestant() = default;

  // Once over each flight.
  void RunRound(const std::vector<SpeedFlight>& flights);

  const std::string& title() const { return title_; }
  const std::string& what() const { return what_; }
  const std::vector<std::string>& variants() const { return variants_; }
  // Of each frame that counts, over all rounds.
  const std::vector<double>& times_ms() const { return times_ms_; }
  // Mean rate of each round.
  const std::vector<double>& round_fps() const { return round_fps_; }
  // Of consecutive frames, mean over all that were scored.
  std::optional<double> rms_px() const;
  // Over all frames that came out, at overlap 5 %; nothing of registration alone.
  std::optional<double> f1() const;

 protected:
  virtual void Run(const SpeedFlight& flight) = 0;

  void AddTime(double ms) { times_ms_.push_back(ms); }
  void Score(const SpeedFlight& flight, std::size_t frame,
             const std::optional<Eigen::Matrix3d>& previous_from_frame);
  void Score(const MotionScore& motion) { motion_ += motion; }

 private:
  std::string title_;
  std::string what_;
  std::vector<std::string> variants_;
  std::vector<double> times_ms_;
  std::vector<double> round_fps_;
  double rms_sum_px_ = 0;
  int rms_pairs_ = 0;
  MotionScore motion_;
};

std::unique_ptr<SpeedContestant> MakeKltContestant();
// `device` is a selector, `name` its figures' part: "cpu".
std::unique_ptr<SpeedContestant> MakeRegistrationContestant(const std::string& device,
                                                            const std::string& name);

struct PipelineContestantSettings {
  std::string device;
  std::string reference = "anchor";
  int frames = 0;  // of each flight, at most
  // Lets a frame in only when all that can have come out have. The time of a frame is then from the
  // entry of the last frame that its window waits for to its own leaving; otherwise it is from its
  // predecessor's leaving to its own.
  bool one_at_a_time = false;
};
std::unique_ptr<SpeedContestant> MakePipelineContestant(const std::string& title,
                                                        const std::string& what,
                                                        const std::vector<std::string>& variants,
                                                        const PipelineContestantSettings& settings);

}  // namespace windhover::replay
