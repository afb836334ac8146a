// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/product_registration.h"

#include <cstring>

namespace windhover::replay {

ProductRegistration::ProductRegistration(const std::shared_ptr<Backend>& backend, int width,
                                         int height, const RegistrationOptions& options)
    : image_(backend->MakeImage<std::uint8_t>(width, height)),
      registration_(backend, width, height, options) {}

std::optional<Eigen::Matrix3d> ProductRegistration::Register(const cv::Mat& gray) {
  {
    const MappedImage<std::uint8_t> pixels = image_.Write();
    for (int y = 0; y < gray.rows; ++y) {
      std::memcpy(pixels.row(y), gray.ptr(y), static_cast<std::size_t>(gray.cols));
    }
  }
  last_ = registration_.Register(image_);
  if (last_.starts_segment || last_.quality == RegistrationQuality::kLost) return std::nullopt;
  return last_.previous_from_frame;
}

void ProductRegistration::Reset() { registration_.Reset(); }

}  // namespace windhover::replay
