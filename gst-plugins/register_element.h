// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "gst-plugins/backend_context.h"
#include "gst-plugins/element.h"
#include "gst-plugins/registration_report.h"
#include "service/options/options.h"
#include "service/vision/registration.h"

namespace windhover {

// whregister: measures how each frame lies over the ground (service/vision/registration.h) and
// attaches a GstWindhoverHomographyMeta. A new frame size, a gap, a discontinuity and a new segment
// each start a new segment on the ground; frame numbers count on.
class RegisterElement : public ElementWithOptions<RegistrationOptions, DeviceOptions> {
 public:
  static const ElementText kText;

  explicit RegisterElement(GstElement* host) : ElementWithOptions(host), shared_(host) {}

  void Start() override;
  void Stop() override;
  void Close() override { shared_.Forget(); }
  void Configure(const GstVideoInfo& info) override;
  GstFlowReturn Process(BufferPtr buffer) override;
  void Reset() override;
  void SetContext(GstContext* context) override { shared_.SetContext(context); }
  bool AnswerContext(GstQuery* query) override { return shared_.Answer(query); }

 private:
  SharedBackend shared_;
  std::shared_ptr<Backend> backend_;
  RegistrationOptions options_;
  GstVideoInfo info_;
  StreamLuma luma_;
  GrayImage gray_;
  std::unique_ptr<StreamRegistration> registration_;
  // Frames numbered by earlier `registration_`s, and in all.
  std::uint64_t frames_before_ = 0;
  std::uint64_t frames_ = 0;
  RegistrationReport report_;
};

}  // namespace windhover
