// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "replay/baselines/phase_correlate_registration.h"
#include "replay/baselines/registration_peer.h"

namespace windhover::replay {

// OpenCV's maximisation of the enhanced correlation coefficient over the eight parameters of a
// homography: exact, slow, and only from a start that is near enough.
class EccRegistration : public RegistrationPeer {
 public:
  enum class Start : std::uint8_t { kIdentity, kPhaseCorrelation };
  explicit EccRegistration(Start start) : start_(start) {}

  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

 private:
  Start start_;
  PhaseCorrelateRegistration phase_;
  cv::Mat previous_;
};

}  // namespace windhover::replay
