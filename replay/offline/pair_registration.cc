// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/pair_registration.h"

#include <cstring>

namespace windhover::replay {
namespace {

// The second picture has the first to go by, and no anchor.
RegistrationOptions ToPrevious(RegistrationOptions options) {
  options.reference = ReferenceMode::kCentre;
  return options;
}

}  // namespace

PairRegistration::PairRegistration(const std::shared_ptr<Backend>& backend, int width, int height,
                                   RegistrationOptions options)
    : image_(backend->MakeImage<std::uint8_t>(width, height)),
      registration_(backend, width, height, ToPrevious(options)) {}

std::optional<Eigen::Matrix3d> PairRegistration::Register(const cv::Mat& first,
                                                          const cv::Mat& second) {
  registration_.Reset();
  Push(first);
  const FrameRegistration found = Push(second);
  if (found.quality == RegistrationQuality::kLost) return std::nullopt;
  return found.previous_from_frame;
}

FrameRegistration PairRegistration::Push(const cv::Mat& picture) {
  {
    const MappedImage<std::uint8_t> pixels = image_.Write();
    for (int y = 0; y < picture.rows; ++y) {
      std::memcpy(pixels.row(y), picture.ptr(y), static_cast<std::size_t>(picture.cols));
    }
  }
  return registration_.Register(image_);
}

}  // namespace windhover::replay
