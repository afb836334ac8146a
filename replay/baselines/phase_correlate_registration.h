// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "replay/baselines/registration_peer.h"

namespace windhover::replay {

// cv::phaseCorrelate over the whole picture under a Hann window: a shift, nothing else.
class PhaseCorrelateRegistration : public RegistrationPeer {
 public:
  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

 private:
  cv::Mat window_;
  cv::Mat previous_;
  cv::Mat current_;
};

}  // namespace windhover::replay
