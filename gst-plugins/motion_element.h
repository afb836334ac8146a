// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gst-plugins/element.h"
#include "service/options/options.h"
#include "service/vision/motion.h"

namespace windhover {

// whmotion: from the evidence of whbackground to tracked detections (service/vision/motion.h), as
// GstVideoRegionOfInterestMeta (detection_meta.h).
class MotionElement : public ElementWithOptions<MotionOptions> {
 public:
  static const ElementText kText;

  using ElementWithOptions::ElementWithOptions;

  void Start() override { motion_.emplace(Options<MotionOptions>()); }
  void Stop() override { motion_.reset(); }
  void Configure(const GstVideoInfo& info) override;
  GstFlowReturn Process(BufferPtr buffer) override;
  void Reset() override;

 private:
  std::optional<MotionDetection> motion_;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace windhover
