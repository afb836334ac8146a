// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "gst-plugins/element.h"
#include "gst-plugins/overlay_drawing.h"
#include "service/options/overlay_options.h"

namespace windhover {

// whoverlay: draws what the other elements have found on the picture (overlay_drawing.h).
class OverlayElement : public ElementWithOptions<OverlayOptions> {
 public:
  static const ElementText kText;
  // Not on 16 bits: what is drawn would be in a range that nobody shows.
  static constexpr const char* kCaps = GST_VIDEO_CAPS_MAKE("{ " WINDHOVER_8_BIT_FORMATS " }");

  using ElementWithOptions::ElementWithOptions;

  void Start() override { drawing_.emplace(Options<OverlayOptions>()); }
  void Stop() override { drawing_.reset(); }
  void Configure(const GstVideoInfo& info) override;
  GstFlowReturn Process(BufferPtr buffer) override;
  void Reset() override;

 private:
  GstVideoInfo info_;
  std::optional<OverlayDrawing> drawing_;
  std::vector<Detection> detections_;
};

}  // namespace windhover
