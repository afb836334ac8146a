// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "service/vision/types.h"

namespace windhover {

// Names of the topics. Types, keys, QoS and units are in idl/README.md.
inline constexpr const char* kHomographyTopic = "windhover/homography";
inline constexpr const char* kDetectionsTopic = "windhover/detections";

// What every sample says about its frame.
struct FrameSample {
  std::string stream;
  // Presentation time as the frame carries it; negative where it carries none.
  std::int64_t pts_ns = -1;
  // Size of the frame, px.
  int width = 0;
  int height = 0;
  // When the publisher wrote the sample, in ns since 1970 by its clock.
  std::int64_t written_ns = 0;
};

struct HomographySample : FrameSample {
  FrameRegistration registration;
};

struct DetectionsSample : FrameSample {
  std::uint64_t frame_number = 0;
  std::vector<Detection> detections;
  // Detections of the frame that found no room in the sample.
  std::uint32_t omitted = 0;
};

}  // namespace windhover
