// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/backend.h"
#include "replay/baselines/registration_peer.h"
#include "service/vision/registration.h"

namespace windhover::replay {

// The product's own registration in the form of its peers.
class ProductRegistration : public RegistrationPeer {
 public:
  // Throws OptionError where the frame is too small for the tiles, and DeviceError.
  ProductRegistration(const std::shared_ptr<Backend>& backend, int width, int height,
                      const RegistrationOptions& options);

  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

  // All that it said about the last frame.
  const FrameRegistration& last() const { return last_; }

 private:
  GrayImage image_;
  StreamRegistration registration_;
  FrameRegistration last_;
};

}  // namespace windhover::replay
