// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cfloat>
#include <cmath>
#include <cstdint>
#include <string>

#include "service/vision/types.h"

namespace windhover {

// A partition of this test program's own, so that tests may run side by side.
inline std::string OwnPartition(const std::string& test) {
  return test + "-" + std::to_string(getpid());
}

// A registration whose numbers differ in every field and from frame to frame.
inline FrameRegistration SampleRegistration(std::uint64_t frame_number, bool anchor) {
  FrameRegistration registration;
  registration.frame_number = frame_number;
  const double x = static_cast<double>(frame_number) + 1.0 / 3.0;
  registration.previous_from_frame << 1.0 + 1e-7 * x, -2e-5, 0.1 * x, 3e-5, 1.0 - 1e-7, -x,
      1e-9 * x, -2e-9, 1.0;
  if (anchor) {
    registration.anchor_from_frame = registration.previous_from_frame * 0.5;
    registration.anchor_number = frame_number / 2;
  }
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      registration.corner_covariance(row, column) = 1e-3 * (row * 8 + column) / x;
    }
  }
  registration.residual_px = 0.1 / x;
  registration.inliers = static_cast<int>(frame_number % 37);
  registration.tiles = 36;
  registration.overlap = 1.0 / x;
  registration.quality = static_cast<RegistrationQuality>(frame_number % 3);
  registration.starts_segment = frame_number % 2 == 0;
  registration.change = static_cast<FrameChange>(frame_number % 5);
  return registration;
}

// The largest and smallest numbers that the fields can hold.
inline FrameRegistration ExtremeRegistration() {
  FrameRegistration registration = SampleRegistration(1, true);
  registration.frame_number = UINT64_MAX;
  registration.anchor_number = UINT64_MAX - 1;
  registration.previous_from_frame << DBL_MAX, -DBL_MAX, DBL_MIN, -DBL_MIN, DBL_TRUE_MIN, -0.0,
      DBL_EPSILON, 1.0 / 3.0, 1.0;
  registration.inliers = INT32_MAX;
  registration.tiles = INT32_MAX;
  registration.residual_px = DBL_MAX;
  return registration;
}

inline Detection SampleDetection(std::uint64_t track_id) {
  Detection detection;
  detection.track_id = track_id;
  const double x = static_cast<double>(track_id) / 7.0;
  detection.box = {x, x + 0.1, x + 0.2, x + 0.3};
  detection.velocity_px = {-x, 1e-12 * x};
  detection.score = 1.0 / (1.0 + x);
  detection.age_frames = static_cast<int>(track_id % 100000);
  return detection;
}

inline bool Same(const Detection& a, const Detection& b) {
  return a.track_id == b.track_id && a.box.x == b.box.x && a.box.y == b.box.y &&
         a.box.width == b.box.width && a.box.height == b.box.height &&
         a.velocity_px == b.velocity_px && a.score == b.score && a.age_frames == b.age_frames;
}

inline bool Same(const FrameRegistration& a, const FrameRegistration& b) {
  return a.frame_number == b.frame_number && a.previous_from_frame == b.previous_from_frame &&
         a.anchor_from_frame == b.anchor_from_frame && a.anchor_number == b.anchor_number &&
         a.corner_covariance == b.corner_covariance && a.residual_px == b.residual_px &&
         a.inliers == b.inliers && a.tiles == b.tiles && a.overlap == b.overlap &&
         a.quality == b.quality && a.starts_segment == b.starts_segment && a.change == b.change;
}

}  // namespace windhover
