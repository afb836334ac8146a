// SPDX-License-Identifier: Apache-2.0
#include "service/vision/camera_path.h"

namespace windhover {
namespace {

// Of a homography with h33 = 1; the square of the smallest change of scale.
constexpr double kMinDeterminant = 1e-4;

std::optional<Eigen::Matrix3d> PreviousFromFrame(const CameraPath::Step& previous,
                                                 const FrameRegistration& frame) {
  if (frame.starts_segment || frame.quality == RegistrationQuality::kLost) return std::nullopt;
  if (frame.frame_number == previous.frame_number + 1) return frame.previous_from_frame;
  if (!frame.anchor_from_frame) return std::nullopt;
  if (frame.anchor_number == previous.frame_number) return frame.anchor_from_frame;
  if (previous.anchor_from_frame && frame.anchor_number == previous.anchor_number) {
    return previous.anchor_from_frame->inverse() * *frame.anchor_from_frame;
  }
  return std::nullopt;
}

}  // namespace

CameraPath::CameraPath(int past, int future)
    : past_(past), steps_(static_cast<std::size_t>(past) + static_cast<std::size_t>(future) + 3) {}

void CameraPath::Push(const FrameRegistration& registration) {
  Step step;
  step.frame_number = registration.frame_number;
  step.anchor_number = registration.anchor_number;
  step.anchor_from_frame = registration.anchor_from_frame;
  if (pushed_ > 0) step.previous_from_frame = PreviousFromFrame(At(pushed_ - 1), registration);
  // A mirrored or flattened picture is no measurement; nor is one that is not finite.
  if (step.previous_from_frame && !(step.previous_from_frame->determinant() > kMinDeterminant)) {
    step.previous_from_frame.reset();
  }
  steps_[pushed_ % steps_.size()] = step;
  ++pushed_;
}

void CameraPath::Reset() {
  pushed_ = 0;
  next_ = 0;
}

}  // namespace windhover
