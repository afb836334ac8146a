// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "gpu-kernels/backend.h"
#include "replay/baselines/registration_peer.h"
#include "service/vision/feature_registration.h"

namespace windhover::replay {

// The thesis' gold standard, registration by local features (its algorithm 1), as the service has
// it for jobs. The features of each frame serve twice: as the frame's and as the next one's
// reference.
class GoldStandardRegistration : public RegistrationPeer {
 public:
  explicit GoldStandardRegistration(const FeatureRegistrationOptions& options);

  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

 private:
  std::shared_ptr<Backend> backend_;
  FeatureRegistration registration_;
  GrayImage image_;
  std::optional<PictureFeatures> previous_;
};

}  // namespace windhover::replay
