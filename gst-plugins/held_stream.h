// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/base/gstqueuearray.h>
#include <gst/gst.h>

#include "gst-plugins/element.h"

namespace windhover {

// A stretch of a stream that is held back: frames, and the serialised events between them, in
// order.
class HeldStream {
 public:
  HeldStream();
  ~HeldStream();
  HeldStream(const HeldStream&) = delete;
  HeldStream& operator=(const HeldStream&) = delete;

  bool empty() const { return gst_queue_array_is_empty(queue_) != FALSE; }

  void AddFrame(BufferPtr buffer);
  // Takes the reference.
  void AddEvent(GstEvent* event);

  // The oldest item where it is a frame, else null. The caller owns it.
  BufferPtr TakeFrame();
  // The oldest item where it is an event, else null. The caller owns it.
  GstEvent* TakeEvent();

  // Drops everything. Sticky events are stored on the pad, as they would be had they been sent.
  void Clear(GstPad* pad);

 private:
  GstQueueArray* queue_;
};

// How long frames are held back, by their time stamps: for streams that do not say their frame
// rate. Starts with the first distance between two frames times the number of frames held, and
// grows where frames were really held for longer.
class MeasuredDelay {
 public:
  explicit MeasuredDelay(int held_frames) : held_frames_(held_frames) {}

  // Both return true where the delay has become known or has grown.
  bool FrameIn(GstClockTime pts);
  bool FrameOut(GstClockTime pts);
  // The frames that follow have nothing to do with the last one.
  void Interrupt() { newest_ = GST_CLOCK_TIME_NONE; }

  // 0 as long as it is not known.
  GstClockTime delay() const { return delay_; }

 private:
  bool Grow(GstClockTime delay);

  int held_frames_;
  GstClockTime newest_ = GST_CLOCK_TIME_NONE;
  GstClockTime delay_ = 0;
};

}  // namespace windhover
