// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "gpu-kernels/backend.h"
#include "replay/baselines/phase_correlate_registration.h"
#include "replay/baselines/registration_peer.h"
#include "service/vision/dual_inverse_compositional.h"

namespace windhover::replay {

// Our own direct registration, over all pixels, of a homography with gain and bias (thesis 2.3.2),
// started from cv::phaseCorrelate as EccRegistration is. The thesis took it for its ground truth.
class DualRegistrationPeer : public RegistrationPeer {
 public:
  DualRegistrationPeer();

  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

 private:
  std::shared_ptr<Backend> backend_;
  PhaseCorrelateRegistration phase_;
  DualInverseCompositional registration_;
  GrayImage previous_;
  GrayImage current_;
  bool has_previous_ = false;
};

}  // namespace windhover::replay
