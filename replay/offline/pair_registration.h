// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "gpu-kernels/backend.h"
#include "service/options/options.h"
#include "service/vision/registration.h"

namespace windhover::replay {

// The product's own registration of two pictures that need not follow each other.
class PairRegistration {
 public:
  // Throws OptionError where the pictures are too small for the tiles, and DeviceError.
  PairRegistration(const std::shared_ptr<Backend>& backend, int width, int height,
                   RegistrationOptions options);

  // Both CV_8UC1 of that size. Returns first_from_second with h33 = 1, or nothing where
  // registration is lost.
  std::optional<Eigen::Matrix3d> Register(const cv::Mat& first, const cv::Mat& second);

 private:
  FrameRegistration Push(const cv::Mat& picture);

  GrayImage image_;
  StreamRegistration registration_;
};

}  // namespace windhover::replay
