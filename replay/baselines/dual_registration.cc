// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/dual_registration.h"

#include <cstring>
#include <utility>

namespace windhover::replay {

DualRegistrationPeer::DualRegistrationPeer() : backend_(Backend::Create("cpu")) {}

std::optional<Eigen::Matrix3d> DualRegistrationPeer::Register(const cv::Mat& gray) {
  const std::optional<Eigen::Matrix3d> start = phase_.Register(gray);
  std::swap(previous_, current_);
  if (current_.empty()) current_ = backend_->MakeImage<std::uint8_t>(gray.cols, gray.rows);
  {
    const MappedImage<std::uint8_t> pixels = current_.Write();
    for (int y = 0; y < gray.rows; ++y) {
      std::memcpy(pixels.row(y), gray.ptr(y), static_cast<std::size_t>(gray.cols));
    }
  }
  if (!std::exchange(has_previous_, true)) return std::nullopt;
  registration_.SetReference(previous_);
  const DualRegistration result =
      registration_.Register(current_, start.value_or(Eigen::Matrix3d::Identity()));
  if (!result.found()) return std::nullopt;
  return result.reference_from_frame;
}

void DualRegistrationPeer::Reset() {
  phase_.Reset();
  has_previous_ = false;
}

}  // namespace windhover::replay
