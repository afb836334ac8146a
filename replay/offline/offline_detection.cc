// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/offline_detection.h"

#include <utility>

#include "replay/offline/luma.h"
#include "service/vision/background.h"
#include "service/vision/motion.h"
#include "service/vision/registration.h"

namespace windhover::replay {

void SetOption(OfflineOptions& options, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw OptionError("expected option=value, got '" + assignment + "'");
  }
  const std::string name = assignment.substr(0, equals);
  const std::string value = assignment.substr(equals + 1);
  if (windhover::SetOption(options.device, name, value) ||
      windhover::SetOption(options.registration, name, value) ||
      windhover::SetOption(options.background, name, value) ||
      windhover::SetOption(options.motion, name, value)) {
    return;
  }
  throw OptionError("there is no option '" + name + "'");
}

struct OfflineDetection::State {
  State(const std::shared_ptr<Backend>& backend, int width, int height,
        const OfflineOptions& options)
      : gray(backend->MakeImage<std::uint8_t>(width, height)),
        registration(backend, width, height, options.registration),
        background(backend, width, height, options.background, options.registration),
        motion(options.motion) {}

  void TakeEvidence() {
    while (const std::shared_ptr<const MotionEvidence> evidence = background.Pop()) {
      outcomes.push_back({evidence->registration, motion.Detect(*evidence)});
    }
  }

  GrayImage gray;
  cv::Mat luma;
  StreamRegistration registration;
  BackgroundSubtraction background;
  MotionDetection motion;
  std::vector<FrameOutcome> outcomes;
};

OfflineDetection::OfflineDetection(std::shared_ptr<Backend> backend, int width, int height,
                                   const OfflineOptions& options)
    : state_(std::make_unique<State>(backend, width, height, options)) {}

OfflineDetection::~OfflineDetection() = default;

void OfflineDetection::Push(const cv::Mat& frame) {
  CopyLuma(frame, state_->luma, state_->gray);
  state_->background.Push(state_->gray, state_->registration.Register(state_->gray));
  state_->TakeEvidence();
}

void OfflineDetection::Drain() {
  state_->background.Drain();
  state_->TakeEvidence();
}

const std::vector<FrameOutcome>& OfflineDetection::outcomes() const { return state_->outcomes; }

std::vector<Eigen::Matrix3d> FirstFromFrame(const std::vector<FrameOutcome>& outcomes) {
  std::vector<Eigen::Matrix3d> composed;
  for (const FrameOutcome& outcome : outcomes) {
    if (composed.empty()) {
      composed.push_back(Eigen::Matrix3d::Identity());
      continue;
    }
    Eigen::Matrix3d next = composed.back() * outcome.registration.previous_from_frame;
    next /= next(2, 2);
    composed.push_back(next);
  }
  return composed;
}

}  // namespace windhover::replay
