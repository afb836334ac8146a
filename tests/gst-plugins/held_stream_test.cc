// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/held_stream.h"

#include <gtest/gtest.h>

namespace windhover {
namespace {

BufferPtr NumberedBuffer(guint64 number) {
  BufferPtr buffer(gst_buffer_new());
  GST_BUFFER_OFFSET(buffer.get()) = number;
  return buffer;
}

TEST(HeldStream, KeepsTheOrderOfFramesAndEvents) {
  HeldStream held;
  EXPECT_TRUE(held.empty());
  EXPECT_EQ(held.TakeFrame(), nullptr);
  EXPECT_EQ(held.TakeEvent(), nullptr);
  held.AddFrame(NumberedBuffer(0));
  held.AddEvent(gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty("mark")));
  held.AddFrame(NumberedBuffer(1));
  EXPECT_EQ(held.TakeEvent(), nullptr);
  EXPECT_EQ(GST_BUFFER_OFFSET(held.TakeFrame().get()), 0u);
  EXPECT_EQ(held.TakeFrame(), nullptr);
  GstEvent* event = held.TakeEvent();
  ASSERT_NE(event, nullptr);
  gst_event_unref(event);
  EXPECT_EQ(GST_BUFFER_OFFSET(held.TakeFrame().get()), 1u);
  EXPECT_TRUE(held.empty());
}

TEST(HeldStream, ClearStoresStickyEvents) {
  GstPad* pad = gst_pad_new("src", GST_PAD_SRC);
  gst_pad_set_active(pad, TRUE);
  gst_pad_store_sticky_event(pad, gst_event_new_stream_start("a"));
  HeldStream held;
  held.AddFrame(NumberedBuffer(0));
  held.AddEvent(gst_event_new_tag(gst_tag_list_new(GST_TAG_TITLE, "flight", nullptr)));
  held.Clear(pad);
  EXPECT_TRUE(held.empty());
  GstEvent* stored = gst_pad_get_sticky_event(pad, GST_EVENT_TAG, 0);
  ASSERT_NE(stored, nullptr);
  gst_event_unref(stored);
  gst_object_unref(pad);
}

TEST(MeasuredDelay, FirstDistanceThenTheLongestHold) {
  constexpr GstClockTime kMs = GST_MSECOND;
  MeasuredDelay delay(3);
  EXPECT_FALSE(delay.FrameIn(100 * kMs));
  EXPECT_EQ(delay.delay(), 0u);
  EXPECT_TRUE(delay.FrameIn(140 * kMs));
  EXPECT_EQ(delay.delay(), 120 * kMs);
  EXPECT_FALSE(delay.FrameIn(180 * kMs));
  EXPECT_FALSE(delay.FrameIn(220 * kMs));
  EXPECT_FALSE(delay.FrameOut(100 * kMs));
  EXPECT_FALSE(delay.FrameIn(300 * kMs));
  EXPECT_TRUE(delay.FrameOut(140 * kMs));  // held for 160 ms
  EXPECT_EQ(delay.delay(), 160 * kMs);
}

TEST(MeasuredDelay, WithoutTimeStampsAndOverInterruptions) {
  MeasuredDelay delay(3);
  EXPECT_FALSE(delay.FrameIn(GST_CLOCK_TIME_NONE));
  EXPECT_FALSE(delay.FrameIn(GST_SECOND));
  delay.Interrupt();
  EXPECT_FALSE(delay.FrameIn(60 * GST_SECOND));
  EXPECT_FALSE(delay.FrameIn(59 * GST_SECOND));  // backwards
  EXPECT_FALSE(delay.FrameOut(GST_CLOCK_TIME_NONE));
  EXPECT_EQ(delay.delay(), 0u);
}

}  // namespace
}  // namespace windhover
