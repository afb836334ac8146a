// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/held_stream.h"

namespace windhover {
namespace {

constexpr guint kUsualItems = 128;

void UnrefItem(gpointer item) { gst_mini_object_unref(static_cast<GstMiniObject*>(item)); }

}  // namespace

HeldStream::HeldStream() : queue_(gst_queue_array_new(kUsualItems)) {
  gst_queue_array_set_clear_func(queue_, UnrefItem);
}

HeldStream::~HeldStream() { gst_queue_array_free(queue_); }

void HeldStream::AddFrame(BufferPtr buffer) { gst_queue_array_push_tail(queue_, buffer.release()); }

void HeldStream::AddEvent(GstEvent* event) { gst_queue_array_push_tail(queue_, event); }

BufferPtr HeldStream::TakeFrame() {
  const gpointer oldest = gst_queue_array_peek_head(queue_);
  if (oldest == nullptr || !GST_IS_BUFFER(oldest)) return nullptr;
  return BufferPtr(GST_BUFFER(gst_queue_array_pop_head(queue_)));
}

GstEvent* HeldStream::TakeEvent() {
  const gpointer oldest = gst_queue_array_peek_head(queue_);
  if (oldest == nullptr || !GST_IS_EVENT(oldest)) return nullptr;
  return GST_EVENT(gst_queue_array_pop_head(queue_));
}

void HeldStream::Clear(GstPad* pad) {
  while (!empty()) {
    const gpointer item = gst_queue_array_pop_head(queue_);
    if (GST_IS_EVENT(item) && GST_EVENT_IS_STICKY(item)) {
      gst_pad_store_sticky_event(pad, GST_EVENT(item));
    }
    UnrefItem(item);
  }
}

bool MeasuredDelay::Grow(GstClockTime delay) {
  if (delay <= delay_) return false;
  delay_ = delay;
  return true;
}

bool MeasuredDelay::FrameIn(GstClockTime pts) {
  const GstClockTime before = newest_;
  newest_ = pts;
  if (delay_ != 0 || !GST_CLOCK_TIME_IS_VALID(before) || !GST_CLOCK_TIME_IS_VALID(pts) ||
      pts <= before) {
    return false;
  }
  return Grow((pts - before) * held_frames_);
}

bool MeasuredDelay::FrameOut(GstClockTime pts) {
  if (!GST_CLOCK_TIME_IS_VALID(pts) || !GST_CLOCK_TIME_IS_VALID(newest_) || newest_ < pts) {
    return false;
  }
  return Grow(newest_ - pts);
}

}  // namespace windhover
