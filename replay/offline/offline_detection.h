// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "service/options/options.h"
#include "service/vision/types.h"

namespace windhover::replay {

// All options of a run on a file.
struct OfflineOptions {
  DeviceOptions device;
  RegistrationOptions registration;
  BackgroundOptions background;
  MotionOptions motion;
};

// Takes "name=value". Throws OptionError where the text is not of that form, no option is called so
// or the value does not fit.
void SetOption(OfflineOptions& options, const std::string& assignment);

struct FrameOutcome {
  FrameRegistration registration;
  std::vector<Detection> detections;
};

// The product's own registration, background subtraction and motion detection, one after the other
// on the calling thread: the same frames give the same outcome.
class OfflineDetection {
 public:
  // Throws OptionError and DeviceError.
  OfflineDetection(std::shared_ptr<Backend> backend, int width, int height,
                   const OfflineOptions& options);
  ~OfflineDetection();

  // `frame` is CV_8UC3, blue first.
  void Push(const cv::Mat& frame);
  // No frame follows.
  void Drain();
  // One entry for each frame that has come out up to now, in order. All have after Drain.
  const std::vector<FrameOutcome>& outcomes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// first_from_frame of each frame, composed from previous_from_frame.
std::vector<Eigen::Matrix3d> FirstFromFrame(const std::vector<FrameOutcome>& outcomes);

}  // namespace windhover::replay
