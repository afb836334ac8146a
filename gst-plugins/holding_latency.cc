// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/holding_latency.h"

#include "gst-plugins/debug.h"

namespace windhover {

void HoldingLatency::Configure(const GstVideoInfo& info, int held_frames) {
  held_buffers_ = static_cast<guint>(held_frames);
  measured_.reset();
  if (GST_VIDEO_INFO_FPS_N(&info) > 0) {
    Set(gst_util_uint64_scale(held_frames * GST_SECOND, GST_VIDEO_INFO_FPS_D(&info),
                              GST_VIDEO_INFO_FPS_N(&info)));
  } else if (held_frames > 0) {
    measured_.emplace(held_frames);
    Set(0);
  }
}

void HoldingLatency::FrameIn(const GstBuffer* buffer) {
  if (measured_ && measured_->FrameIn(GST_BUFFER_PTS(buffer))) Set(measured_->delay());
}

void HoldingLatency::FrameOut(const GstBuffer* buffer) {
  if (measured_ && measured_->FrameOut(GST_BUFFER_PTS(buffer))) Set(measured_->delay());
}

void HoldingLatency::Interrupt() {
  if (measured_) measured_->Interrupt();
}

void HoldingLatency::Stop() {
  measured_.reset();
  latency_ = 0;
  held_buffers_ = 0;
}

void HoldingLatency::Set(GstClockTime latency) {
  if (latency_.exchange(latency) == latency) return;
  GST_INFO_OBJECT(host_, "holding frames adds a latency of %" GST_TIME_FORMAT,
                  GST_TIME_ARGS(latency));
  gst_element_post_message(host_, gst_message_new_latency(GST_OBJECT(host_)));
}

}  // namespace windhover
