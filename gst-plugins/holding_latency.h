// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <atomic>
#include <optional>

#include "gst-plugins/held_stream.h"

namespace windhover {

// The latency that an element adds by holding frames back: from the caps' frame rate, or measured
// where they give none. Tells the pipeline where it becomes known or changes.
class HoldingLatency {
 public:
  explicit HoldingLatency(GstElement* host) : host_(host) {}

  // New caps, and how many frames are held.
  void Configure(const GstVideoInfo& info, int held_frames);
  void FrameIn(const GstBuffer* buffer);
  void FrameOut(const GstBuffer* buffer);
  // The frames that follow have nothing to do with the last one.
  void Interrupt();
  // Nothing is held.
  void Stop();

  // From any thread.
  GstClockTime latency() const { return latency_; }
  guint held_buffers() const { return held_buffers_; }

 private:
  void Set(GstClockTime latency);

  GstElement* host_;
  // Only where the caps say no frame rate.
  std::optional<MeasuredDelay> measured_;
  std::atomic<GstClockTime> latency_ = 0;
  std::atomic<guint> held_buffers_ = 0;
};

}  // namespace windhover
