// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/background_element.h"

#include <stdexcept>
#include <utility>

#include "gst-plugins/evidence_meta.h"
#include "gst-plugins/luma.h"
#include "gst-plugins/video_frame_map.h"
#include "service/gstreamer/homography_meta.h"

namespace windhover {

const ElementText BackgroundElement::kText = {
    "whbackground", "GstWindhoverBackground", "Aerial video background subtraction",
    "Filter/Analyzer/Video",
    "Lays the frames of a sliding window over each other as whregister measured them, takes the "
    "pixel-wise median as background and marks what differs from it, for whmotion. Holds back "
    "'lookahead' frames and says so in its latency; pictures pass unchanged. The registration "
    "properties count only where whregister runs with reference=centre"};

void BackgroundElement::InstallProperties(GObjectClass* klass) {
  // Each frame says in which mode it was registered.
  OptionProperties<BackgroundOptions, DeviceOptions, RegistrationOptions>::Install(
      klass, GST_PARAM_MUTABLE_READY, {"reference"});
}

void BackgroundElement::Start() {
  options_ = Options<BackgroundOptions>();
  registration_options_ = Options<RegistrationOptions>();
  registration_options_.reference = ReferenceMode::kCentre;
  backend_ = shared_.Acquire(Options<DeviceOptions>().device);
}

void BackgroundElement::Stop() {
  held_.Clear(source_pad());
  background_.reset();
  luma_ = {};
  gray_ = {};
  backend_.reset();
  latency_.Stop();
}

void BackgroundElement::Configure(const GstVideoInfo& info) {
  info_ = info;
  const int width = GST_VIDEO_INFO_WIDTH(&info);
  const int height = GST_VIDEO_INFO_HEIGHT(&info);
  if (background_ == nullptr || gray_.width() != width || gray_.height() != height) {
    background_.reset();
    luma_.Reset();
    background_ = std::make_unique<BackgroundSubtraction>(backend_, width, height, options_,
                                                          registration_options_);
    gray_ = backend_->MakeImage<std::uint8_t>(width, height);
  }
  latency_.Configure(info, background_->lookahead());
}

GstFlowReturn BackgroundElement::Process(BufferPtr buffer) {
  const auto* meta = gst_buffer_get_windhover_homography_meta(buffer.get());
  if (meta == nullptr || meta->width != gray_.width() || meta->height != gray_.height()) {
    throw std::runtime_error("whbackground needs whregister before it, at the same frame size");
  }
  bool jumped = false;
  {
    const VideoFrameMap map(info_, buffer.get(), GST_MAP_READ);
    jumped = luma_.Extract(map.frame(), gray_);
  }
  if (jumped) {
    const GstFlowReturn drained = Drain();
    if (drained != GST_FLOW_OK) return drained;
  }
  background_->Push(gray_, meta->registration);
  latency_.FrameIn(buffer.get());
  held_.AddFrame(std::move(buffer));
  return SendComplete();
}

GstFlowReturn BackgroundElement::SendComplete() {
  while (std::shared_ptr<const MotionEvidence> evidence = background_->Pop()) {
    BufferPtr buffer = held_.TakeFrame();
    if (buffer == nullptr) throw std::logic_error("evidence for a frame that is not held");
    latency_.FrameOut(buffer.get());
    buffer = MakeWritable(std::move(buffer));
    AddEvidence(buffer.get(), std::move(evidence));
    const GstFlowReturn result = Push(std::move(buffer));
    if (result != GST_FLOW_OK) {
      // A flush or the end must not wait for evidence that nobody takes.
      Reset();
      return result;
    }
    while (GstEvent* event = held_.TakeEvent()) PushEvent(event);
  }
  return GST_FLOW_OK;
}

bool BackgroundElement::Forward(GstEvent* event) {
  if (held_.empty()) return PushEvent(event);
  held_.AddEvent(event);
  return true;
}

GstFlowReturn BackgroundElement::Drain() {
  if (background_ == nullptr) return GST_FLOW_OK;
  background_->Drain();
  const GstFlowReturn result = SendComplete();
  background_->Reset();
  latency_.Interrupt();
  return result;
}

void BackgroundElement::Reset() {
  luma_.Reset();
  held_.Clear(source_pad());
  if (background_ != nullptr) background_->Reset();
  latency_.Interrupt();
}

}  // namespace windhover
