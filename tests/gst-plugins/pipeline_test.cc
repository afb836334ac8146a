// SPDX-License-Identifier: Apache-2.0
// Whole pipelines with threads of their own.

#include <gst/gst.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <string>

#include "tests/gst-plugins/harness.h"

namespace windhover {
namespace {

constexpr char kSource[] =
    "videotestsrc num-buffers=30 pattern=zone-plate kx2=8 ky2=8 kt=1 ! "
    "video/x-raw,format=NV12,width=176,height=144,framerate=25/1";

std::string Analysis(const std::string& stream) {
  return "whregister device=cpu ! whbackground device=cpu k=4 lookahead=4 ! whmotion ! "
         "whpublish stream=gst-test-" +
         std::to_string(getpid()) + stream + " ! whoverlay";
}

class Pipeline {
 public:
  explicit Pipeline(const std::string& launch) : pipeline_(MakePipeline(launch)) {}

  // Counts the buffers that reach the sink of that name.
  void Count(const char* sink, std::atomic<int>* count) {
    GstElement* element = gst_bin_get_by_name(GST_BIN(get()), sink);
    GstPad* pad = gst_element_get_static_pad(element, "sink");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo*, gpointer data) {
          ++*static_cast<std::atomic<int>*>(data);
          return GST_PAD_PROBE_OK;
        },
        count, nullptr);
    gst_object_unref(pad);
    gst_object_unref(element);
  }
  void Play() { gst_element_set_state(get(), GST_STATE_PLAYING); }
  // True at the end of the stream, false at an error.
  bool WaitForEnd() {
    GstBus* bus = gst_element_get_bus(get());
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, 120 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    const bool ended = message != nullptr && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    if (message != nullptr) gst_message_unref(message);
    gst_object_unref(bus);
    return ended;
  }
  GstElement* get() { return pipeline_.get(); }

 private:
  ElementPtr pipeline_;
};

TEST(Pipeline, TwoAtOnce) {
  std::array<std::atomic<int>, 2> counts = {};
  Pipeline a(std::string(kSource) + " ! " + Analysis("a") + " ! fakesink name=sink");
  Pipeline b(std::string(kSource) + " ! " + Analysis("b") + " ! fakesink name=sink");
  a.Count("sink", &counts[0]);
  b.Count("sink", &counts[1]);
  a.Play();
  b.Play();
  EXPECT_TRUE(a.WaitForEnd());
  EXPECT_TRUE(b.WaitForEnd());
  EXPECT_EQ(counts[0], 30);
  EXPECT_EQ(counts[1], 30);
}

TEST(Pipeline, BehindTeeAndQueue) {
  std::array<std::atomic<int>, 3> counts = {};
  Pipeline pipeline(std::string(kSource) +
                    " ! tee name=t  t. ! queue ! fakesink name=plain "
                    " t. ! queue ! " +
                    Analysis("a") + " ! queue ! fakesink name=first " + " t. ! queue ! " +
                    Analysis("b") +
                    " ! videoconvert ! video/x-raw,format=RGB ! fakesink name=second");
  pipeline.Count("plain", &counts[0]);
  pipeline.Count("first", &counts[1]);
  pipeline.Count("second", &counts[2]);
  pipeline.Play();
  EXPECT_TRUE(pipeline.WaitForEnd());
  for (const auto& count : counts) EXPECT_EQ(count, 30);
}

// A tee between whbackground and two whmotion: both get the evidence.
TEST(Pipeline, TeeInTheMiddle) {
  std::array<std::atomic<int>, 2> counts = {};
  Pipeline pipeline(
      std::string(kSource) +
      " ! whregister device=cpu ! whbackground device=cpu k=4 lookahead=4 ! tee name=t "
      " t. ! queue ! whmotion ! fakesink name=first "
      " t. ! queue ! whmotion ! fakesink name=second");
  pipeline.Count("first", &counts[0]);
  pipeline.Count("second", &counts[1]);
  pipeline.Play();
  EXPECT_TRUE(pipeline.WaitForEnd());
  EXPECT_EQ(counts[0], 30);
  EXPECT_EQ(counts[1], 30);
}

TEST(Pipeline, LiveSourceInASyncedSink) {
  std::atomic<int> count = 0;
  Pipeline pipeline(
      "videotestsrc is-live=true num-buffers=30 pattern=zone-plate kx2=8 ky2=8 kt=1 ! "
      "video/x-raw,format=I420,width=176,height=144,framerate=60/1 ! " +
      Analysis("live") + " ! fakesink name=sink sync=true");
  pipeline.Count("sink", &count);
  pipeline.Play();
  EXPECT_TRUE(pipeline.WaitForEnd());
  EXPECT_EQ(count, 30);
  GstQuery* query = gst_query_new_latency();
  ASSERT_TRUE(gst_element_query(pipeline.get(), query));
  gboolean live = FALSE;
  GstClockTime minimum = 0;
  gst_query_parse_latency(query, &live, &minimum, nullptr);
  EXPECT_TRUE(live);
  EXPECT_GE(minimum, 4 * GST_SECOND / 60);
  gst_query_unref(query);
}

TEST(Pipeline, GoesOnAfterAFlushingSeek) {
  for (int round = 0; round < 3; ++round) {
    Pipeline pipeline(
        "videotestsrc ! video/x-raw,format=GRAY8,width=176,height=144,framerate=25/1 ! " +
        Analysis("stop") + " ! fakesink");
    gst_element_set_state(pipeline.get(), GST_STATE_PAUSED);
    ASSERT_EQ(gst_element_get_state(pipeline.get(), nullptr, nullptr, 60 * GST_SECOND),
              GST_STATE_CHANGE_SUCCESS);
    ASSERT_TRUE(gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                        10 * GST_SECOND));
    ASSERT_EQ(gst_element_get_state(pipeline.get(), nullptr, nullptr, 60 * GST_SECOND),
              GST_STATE_CHANGE_SUCCESS);
  }
}

}  // namespace
}  // namespace windhover
