// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/overlay_element.h"

#include <utility>

#include "gst-plugins/video_frame_map.h"
#include "service/gstreamer/detection_meta.h"
#include "service/gstreamer/homography_meta.h"

namespace windhover {

const ElementText OverlayElement::kText = {
    "whoverlay", "GstWindhoverOverlay", "Aerial video overlay", "Filter/Effect/Video",
    "Draws on the picture what whregister and whmotion have found: boxes, track numbers, trails "
    "that "
    "stay on the ground while the camera moves, and a line about the registration. A frame whose "
    "registration is lost gets a red frame"};

void OverlayElement::Configure(const GstVideoInfo& info) {
  info_ = info;
  Reset();
}

GstFlowReturn OverlayElement::Process(BufferPtr buffer) {
  buffer = MakeWritable(std::move(buffer));
  GetDetections(buffer.get(), GST_VIDEO_INFO_WIDTH(&info_), GST_VIDEO_INFO_HEIGHT(&info_),
                detections_);
  const auto* meta = gst_buffer_get_windhover_homography_meta(buffer.get());
  {
    const VideoFrameMap map(info_, buffer.get(), GST_MAP_READWRITE);
    Canvas canvas(map.frame());
    drawing_->Draw(meta != nullptr ? &meta->registration : nullptr, detections_, canvas);
  }
  return Push(std::move(buffer));
}

void OverlayElement::Reset() {
  if (drawing_) drawing_->Reset();
}

}  // namespace windhover
