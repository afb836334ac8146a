// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "gst-plugins/element.h"
#include "gst-plugins/held_stream.h"
#include "gst-plugins/holding_latency.h"
#include "gst-plugins/mosaic.h"
#include "gst-plugins/picture_planes.h"
#include "service/gstreamer/objects.h"
#include "service/options/stabilisation_options.h"
#include "service/vision/stabilisation.h"

namespace windhover {

// whstabilize: shows the frames so that the ground, or the camera's smoothed way, holds still
// (service/vision/stabilisation.h). In mode=smooth holds each frame until `smoothing-lookahead`
// later ones have come.
class StabilizeElement : public ElementWithOptions<StabilisationOptions> {
 public:
  static const ElementText kText;
  // Not on 16 bits, which are not for showing.
  static constexpr const char* kCaps = GST_VIDEO_CAPS_MAKE("{ " WINDHOVER_8_BIT_FORMATS " }");

  explicit StabilizeElement(GstElement* host) : ElementWithOptions(host), latency_(host) {}

  void Start() override { options_ = Options<StabilisationOptions>(); }
  void Stop() override;
  void Configure(const GstVideoInfo& info) override;
  GstFlowReturn Process(BufferPtr buffer) override;
  bool Forward(GstEvent* event) override;
  GstFlowReturn Drain() override;
  void Reset() override;
  GstClockTime added_latency() const override { return latency_.latency(); }
  guint held_buffers() const override { return latency_.held_buffers(); }

 private:
  // Sends on each frame whose pose is known. Drops all that is held where that fails.
  GstFlowReturn SendKnown();
  BufferPtr Show(GstBuffer* frame, const ScreenPose& pose);
  void Draw(const PicturePlanes& frame, const ScreenPose& pose, PicturePlanes& screen);

  StabilisationOptions options_;
  GstVideoInfo info_;
  std::optional<Stabilisation> stabilisation_;
  HeldStream held_;
  HoldingLatency latency_;
  Mosaic mosaic_;
  ObjectPtr<GstBufferPool> pool_;  // of the pictures that are sent on
};

}  // namespace windhover
