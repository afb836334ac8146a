// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/gold_standard_registration.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "service/vision/homography.h"

namespace windhover::replay {

GoldStandardRegistration::GoldStandardRegistration(const FeatureRegistrationOptions& options)
    : backend_(Backend::Create("cpu")), registration_(options) {}

std::optional<Eigen::Matrix3d> GoldStandardRegistration::Register(const cv::Mat& gray) {
  if (image_.empty()) image_ = backend_->MakeImage<std::uint8_t>(gray.cols, gray.rows);
  {
    const MappedImage<std::uint8_t> pixels = image_.Write();
    for (int y = 0; y < gray.rows; ++y) std::copy_n(gray.ptr(y), gray.cols, pixels.row(y));
  }
  PictureFeatures features = registration_.Detect(image_);
  const std::optional<PictureFeatures> previous = std::exchange(previous_, std::move(features));
  if (!previous) return std::nullopt;
  const FeatureRegistrationResult result = registration_.Register(*previous, *previous_);
  if (result.failure) return std::nullopt;
  return InverseHomography(result.frame_from_reference);
}

void GoldStandardRegistration::Reset() { previous_.reset(); }

}  // namespace windhover::replay
