// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/motion_element.h"

#include <memory>
#include <stdexcept>
#include <utility>

#include "gst-plugins/evidence_meta.h"
#include "service/gstreamer/detection_meta.h"

namespace windhover {

const ElementText MotionElement::kText = {
    "whmotion", "GstWindhoverMotion", "Aerial video motion detection", "Filter/Analyzer/Video",
    "Finds what moves over the ground in the evidence of whbackground: voting filter, "
    "forward-backward filter, boxes, tracks with stable ids. Detections are "
    "GstVideoRegionOfInterestMeta of the type 'moving-object' with the structures 'detection', "
    "'object_id' and 'motion'; pictures pass unchanged"};

void MotionElement::Configure(const GstVideoInfo& info) {
  const int width = GST_VIDEO_INFO_WIDTH(&info);
  const int height = GST_VIDEO_INFO_HEIGHT(&info);
  if (width_ != width || height_ != height) Reset();
  width_ = width;
  height_ = height;
}

GstFlowReturn MotionElement::Process(BufferPtr buffer) {
  buffer = MakeWritable(std::move(buffer));
  const std::shared_ptr<const MotionEvidence> evidence = TakeEvidence(buffer.get());
  if (evidence == nullptr || evidence->frame_width != width_ || evidence->frame_height != height_) {
    throw std::runtime_error("whmotion needs whbackground before it, at the same frame size");
  }
  AddDetections(buffer.get(), motion_->Detect(*evidence), width_, height_);
  return Push(std::move(buffer));
}

void MotionElement::Reset() {
  if (motion_) motion_->Reset();
}

}  // namespace windhover
