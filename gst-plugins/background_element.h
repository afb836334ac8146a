// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gst-plugins/backend_context.h"
#include "gst-plugins/element.h"
#include "gst-plugins/held_stream.h"
#include "gst-plugins/holding_latency.h"
#include "service/options/options.h"
#include "service/vision/background.h"

namespace windhover {

// whbackground: the sliding window and its motion seeds (service/vision/background.h). Holds each
// frame until `lookahead` later ones have come, then sends it on with its MotionEvidence.
class BackgroundElement
    : public ElementWithOptions<BackgroundOptions, DeviceOptions, RegistrationOptions> {
 public:
  static const ElementText kText;
  static void InstallProperties(GObjectClass* klass);

  explicit BackgroundElement(GstElement* host)
      : ElementWithOptions(host), shared_(host), latency_(host) {}

  void Start() override;
  void Stop() override;
  void Close() override { shared_.Forget(); }
  void Configure(const GstVideoInfo& info) override;
  GstFlowReturn Process(BufferPtr buffer) override;
  bool Forward(GstEvent* event) override;
  GstFlowReturn Drain() override;
  void Reset() override;
  GstClockTime added_latency() const override { return latency_.latency(); }
  guint held_buffers() const override { return latency_.held_buffers(); }
  void SetContext(GstContext* context) override { shared_.SetContext(context); }
  bool AnswerContext(GstQuery* query) override { return shared_.Answer(query); }

 private:
  // Sends on each frame whose evidence is complete. Drops all that is held where that fails.
  GstFlowReturn SendComplete();

  SharedBackend shared_;
  std::shared_ptr<Backend> backend_;
  BackgroundOptions options_;
  RegistrationOptions registration_options_;
  GstVideoInfo info_;
  StreamLuma luma_;
  GrayImage gray_;
  std::unique_ptr<BackgroundSubtraction> background_;
  HeldStream held_;
  HoldingLatency latency_;
};

}  // namespace windhover
