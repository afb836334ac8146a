// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/offline_registration.h"

#include <memory>
#include <opencv2/imgproc.hpp>

#include "replay/offline/product_registration.h"

namespace windhover::replay {

std::vector<FrameRegistration> RegisterFrames(FrameSource& source,
                                              const std::shared_ptr<Backend>& backend,
                                              const RegistrationOptions& options, int most_frames,
                                              const std::function<void()>& on_frame) {
  std::vector<FrameRegistration> outcomes;
  std::unique_ptr<ProductRegistration> registration;
  cv::Mat gray;
  while (most_frames == 0 || static_cast<int>(outcomes.size()) < most_frames) {
    const cv::Mat frame = source.Next();
    if (frame.empty()) break;
    if (!registration) {
      registration =
          std::make_unique<ProductRegistration>(backend, frame.cols, frame.rows, options);
    }
    cv::cvtColor(frame, gray, cv::COLOR_BGR2GRAY);
    registration->Register(gray);
    outcomes.push_back(registration->last());
    on_frame();
  }
  return outcomes;
}

}  // namespace windhover::replay
