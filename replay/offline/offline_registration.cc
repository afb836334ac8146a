// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/offline_registration.h"

#include <opencv2/core.hpp>

#include "replay/offline/luma.h"
#include "service/vision/registration.h"

namespace windhover::replay {

std::vector<FrameRegistration> RegisterFrames(FrameSource& source,
                                              const std::shared_ptr<Backend>& backend,
                                              const RegistrationOptions& options, int most_frames,
                                              const std::function<void()>& on_frame) {
  std::vector<FrameRegistration> outcomes;
  std::unique_ptr<StreamRegistration> registration;
  GrayImage gray;
  cv::Mat luma;
  while (most_frames == 0 || static_cast<int>(outcomes.size()) < most_frames) {
    const cv::Mat frame = source.Next();
    if (frame.empty()) break;
    if (!registration) {
      gray = backend->MakeImage<std::uint8_t>(frame.cols, frame.rows);
      registration = std::make_unique<StreamRegistration>(backend, frame.cols, frame.rows, options);
    }
    CopyLuma(frame, luma, gray);
    outcomes.push_back(registration->Register(gray));
    on_frame();
  }
  return outcomes;
}

}  // namespace windhover::replay
