// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "gst-plugins/evidence_meta.h"
#include "service/gstreamer/homography_meta.h"
#include "tests/gst-plugins/harness.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

constexpr int kWidth = 161;
constexpr int kHeight = 121;

std::string Chain(int k, int lookahead, const std::string& reference = "anchor") {
  return "whregister device=cpu tile-columns=4 tile-rows=4 reference=" + reference +
         " ! whbackground name=background device=cpu tile-columns=4 tile-rows=4 k=" +
         std::to_string(k) + " lookahead=" + std::to_string(lookahead);
}

struct WindowCase {
  int k;
  int lookahead;
  const char* reference;
};

void PrintTo(const WindowCase& c, std::ostream* out) {
  *out << c.k << " " << c.lookahead << " " << c.reference;
}

class WindowTest : public testing::TestWithParam<WindowCase> {
 protected:
  TestVideo video_{kWidth, kHeight};
};

TEST_P(WindowTest, EveryFrameComesOutOnceInOrder) {
  const auto [k, lookahead, reference] = GetParam();
  Harness harness(Chain(k, lookahead, reference));
  harness.SetCaps(video_.Caps());
  const int held = std::min(k, lookahead);
  constexpr int kFrames = 12;
  std::vector<BufferPtr> out;
  for (int t = 0; t < kFrames; ++t) {
    BufferPtr in = video_.Frame(t);
    GST_BUFFER_FLAG_SET(in.get(), t == 5 ? GST_BUFFER_FLAG_GAP : GST_BUFFER_FLAG_MARKER);
    gst_buffer_add_reference_timestamp_meta(in.get(), gst_caps_new_empty_simple("timestamp/x-test"),
                                            t, GST_CLOCK_TIME_NONE);
    ASSERT_EQ(harness.Push(std::move(in)), GST_FLOW_OK);
    for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
    EXPECT_EQ(out.size(), static_cast<std::size_t>(std::max(0, t + 1 - held)));
  }
  EXPECT_TRUE(harness.PushEvent(gst_event_new_eos()));
  for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
  ASSERT_EQ(out.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(harness.log().back(), "eos");
  for (int t = 0; t < kFrames; ++t) {
    SCOPED_TRACE(t);
    GstBuffer* buffer = out[t].get();
    EXPECT_EQ(GST_BUFFER_PTS(buffer), TestVideo::kFirstPts + t * TestVideo::kFrameTime);
    EXPECT_EQ(GST_BUFFER_DURATION(buffer), TestVideo::kFrameTime);
    EXPECT_EQ(GST_BUFFER_OFFSET(buffer), static_cast<guint64>(t));
    EXPECT_EQ(GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP), t == 5);
    EXPECT_EQ(GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_MARKER), t != 5);
    EXPECT_FALSE(GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT));
    const auto* stamp = gst_buffer_get_reference_timestamp_meta(buffer, nullptr);
    ASSERT_NE(stamp, nullptr);
    EXPECT_EQ(stamp->timestamp, static_cast<GstClockTime>(t));
    const auto* homography = gst_buffer_get_windhover_homography_meta(buffer);
    ASSERT_NE(homography, nullptr);
    EXPECT_EQ(homography->registration.frame_number, static_cast<std::uint64_t>(t));
    const auto evidence = TakeEvidence(buffer);
    ASSERT_NE(evidence, nullptr);
    EXPECT_EQ(evidence->registration.frame_number, static_cast<std::uint64_t>(t));
    EXPECT_EQ(evidence->frame_width, kWidth);
    const int after = evidence->samples.back().offset_frames;
    EXPECT_EQ(after, std::min(held, kFrames - 1 - t));
    EXPECT_EQ(evidence->samples.front().offset_frames, -std::min(k, t));
  }
  EXPECT_TRUE(harness.Errors().empty());
}

INSTANTIATE_TEST_SUITE_P(Windows, WindowTest,
                         testing::Values(WindowCase{4, 4, "anchor"}, WindowCase{4, 4, "centre"},
                                         WindowCase{4, 2, "anchor"}, WindowCase{4, 0, "anchor"},
                                         WindowCase{2, 9, "anchor"}, WindowCase{20, 20, "anchor"},
                                         WindowCase{4, 2, "centre"}),
                         [](const auto& info) {
                           return "K" + std::to_string(info.param.k) + "Lookahead" +
                                  std::to_string(info.param.lookahead) + info.param.reference;
                         });

class BackgroundElementTest : public testing::Test {
 protected:
  // Positions of the entries in what came out.
  static std::ptrdiff_t At(const Harness& harness, const std::string& entry) {
    const auto& log = harness.log();
    return std::find(log.begin(), log.end(), entry) - log.begin();
  }

  TestVideo video_{kWidth, kHeight};
};

TEST_F(BackgroundElementTest, LatencyFollowsTheLookahead) {
  for (const auto [k, lookahead, frames] :
       {std::array{4, 4, 4}, {4, 2, 2}, {4, 0, 0}, {3, 40, 3}}) {
    Harness harness(Chain(k, lookahead));
    harness.SetCaps(video_.Caps());
    EXPECT_EQ(harness.Latency(), frames * TestVideo::kFrameTime);
    gst_harness_set_upstream_latency(harness.get(), 11 * GST_MSECOND);
    EXPECT_EQ(harness.Latency(), frames * TestVideo::kFrameTime + 11 * GST_MSECOND);
  }
}

TEST_F(BackgroundElementTest, LatencyIsMeasuredWhereCapsSayNoFrameRate) {
  Harness harness(Chain(4, 4));
  harness.SetCaps(video_.Caps(false));
  EXPECT_EQ(harness.Latency(), 0u);
  harness.CountMessages(GST_MESSAGE_LATENCY);
  harness.Push(video_.Frame(0));
  EXPECT_EQ(harness.CountMessages(GST_MESSAGE_LATENCY), 0);
  harness.Push(video_.Frame(1));
  EXPECT_EQ(harness.CountMessages(GST_MESSAGE_LATENCY), 1);
  EXPECT_EQ(harness.Latency(), 4 * TestVideo::kFrameTime);
  for (int t = 2; t < 10; ++t) harness.Push(video_.Frame(t));
  EXPECT_EQ(harness.CountMessages(GST_MESSAGE_LATENCY), 0) << "frames that keep their distance";
}

TEST_F(BackgroundElementTest, FlushDropsWhatIsHeld) {
  Harness harness(Chain(4, 4));
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  EXPECT_EQ(harness.PullAll().size(), 2u);
  harness.Flush();
  for (int t = 20; t < 30; ++t) EXPECT_EQ(harness.Push(video_.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 10u);
  EXPECT_EQ(GST_BUFFER_OFFSET(out[0].get()), 20u);
  EXPECT_EQ(TakeEvidence(out[0].get())->samples.front().offset_frames, 0)
      << "no window reaches over the flush";
}

TEST_F(BackgroundElementTest, StickyEventsSurviveAFlush) {
  Harness harness(Chain(4, 4));
  harness.SetCaps(video_.Caps());
  harness.Push(video_.Frame(0));
  harness.PushEvent(gst_event_new_tag(gst_tag_list_new(GST_TAG_TITLE, "flight", nullptr)));
  EXPECT_EQ(At(harness, "tag"), std::ssize(harness.log())) << "held behind its frame";
  harness.Flush();
  for (int t = 20; t < 25; ++t) harness.Push(video_.Frame(t));
  EXPECT_LT(At(harness, "tag"), At(harness, "b20"));
}

TEST_F(BackgroundElementTest, EventsKeepTheirPlaceBetweenFrames) {
  Harness harness(Chain(3, 3));
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 10; ++t) {
    harness.Push(video_.Frame(t));
    if (t == 4) {
      harness.PushEvent(
          gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty("mark")));
    }
  }
  harness.PushEvent(gst_event_new_eos());
  EXPECT_EQ(At(harness, "custom-downstream"), At(harness, "b4") + 1);
  EXPECT_EQ(At(harness, "b5"), At(harness, "b4") + 2);
}

TEST_F(BackgroundElementTest, OutOfBandEventsDoNotWait) {
  Harness harness(Chain(3, 3));
  harness.SetCaps(video_.Caps());
  harness.Push(video_.Frame(0));
  harness.PushEvent(
      gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_OOB, gst_structure_new_empty("now")));
  EXPECT_LT(At(harness, "custom-downstream-oob"), std::ssize(harness.log()));
  EXPECT_EQ(At(harness, "b0"), std::ssize(harness.log()));
}

TEST_F(BackgroundElementTest, CapsChangeDrainsTheOldFirst) {
  Harness harness(Chain(4, 4));
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  TestVideo larger(200, 140);
  harness.SetCaps(larger.Caps());
  for (int t = 6; t < 12; ++t) EXPECT_EQ(harness.Push(larger.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 12u);
  const auto& log = harness.log();
  const auto second_caps =
      std::find(log.begin() + At(harness, "b0"), log.end(), "caps") - log.begin();
  EXPECT_GT(second_caps, At(harness, "b5"));
  EXPECT_LT(second_caps, At(harness, "b6"));
  for (std::size_t t = 0; t < 12; ++t) {
    EXPECT_EQ(GST_BUFFER_OFFSET(out[t].get()), t);
    const auto evidence = TakeEvidence(out[t].get());
    EXPECT_EQ(evidence->frame_width, t < 6 ? kWidth : 200);
    if (t == 6) {
      EXPECT_EQ(evidence->samples.front().offset_frames, 0);
    }
  }
}

// Both say that nothing follows soon.
TEST_F(BackgroundElementTest, EndsOfSegmentsDrain) {
  for (const bool group : {false, true}) {
    Harness harness(Chain(4, 4));
    harness.SetCaps(video_.Caps());
    for (int t = 0; t < 3; ++t) harness.Push(video_.Frame(t));
    harness.PushEvent(group ? gst_event_new_stream_group_done(1)
                            : gst_event_new_segment_done(GST_FORMAT_TIME, GST_SECOND));
    EXPECT_EQ(At(harness, "b2"), std::ssize(harness.log()) - 2);
  }
}

TEST_F(BackgroundElementTest, EvidenceOutlivesTheElements) {
  std::vector<BufferPtr> out;
  {
    Harness harness(Chain(2, 2));
    harness.SetCaps(video_.Caps());
    for (int t = 0; t < 4; ++t) harness.Push(video_.Frame(t));
    out = harness.PullAll();
  }
  ASSERT_EQ(out.size(), 2u);
  const auto evidence = TakeEvidence(out[1].get());
  ASSERT_NE(evidence, nullptr);
  EXPECT_EQ(evidence->background->Read().width(), evidence->background->width());
}

TEST_F(BackgroundElementTest, GapAndDiscontDrain) {
  for (const bool discont : {false, true}) {
    Harness harness(Chain(4, 4));
    harness.SetCaps(video_.Caps());
    for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
    BufferPtr next = video_.Frame(6);
    if (discont) {
      GST_BUFFER_FLAG_SET(next.get(), GST_BUFFER_FLAG_DISCONT);
      harness.Push(std::move(next));
    } else {
      harness.PushEvent(gst_event_new_gap(GST_BUFFER_PTS(next.get()), GST_SECOND));
      EXPECT_EQ(harness.log().back(), "gap");
    }
    EXPECT_LT(At(harness, "b5"), std::ssize(harness.log()));
    EXPECT_EQ(At(harness, "b6"), std::ssize(harness.log()));
  }
}

// The evidence takes long to compute; where nobody takes it, a flush or the end must not wait.
TEST_F(BackgroundElementTest, DrainStopsWhereNobodyTakesTheFrames) {
  Harness harness(Chain(4, 4));
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  ASSERT_EQ(harness.PullAll().size(), 2u);
  GstElement* background = harness.Find("background");
  GstPad* pad = gst_element_get_static_pad(background, "src");
  int tried = 0;
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo*, gpointer count) {
        ++*static_cast<int*>(count);
        return GST_PAD_PROBE_OK;
      },
      &tried, nullptr);
  gst_object_unref(pad);
  gst_object_unref(background);
  GST_PAD_SET_FLUSHING(harness.get()->sinkpad);
  harness.PushEvent(gst_event_new_gap(GST_SECOND, GST_SECOND));
  EXPECT_EQ(tried, 1);

  // What was held is gone as a whole; the frames that follow find their own evidence.
  GST_PAD_UNSET_FLUSHING(harness.get()->sinkpad);
  for (int t = 6; t < 12; ++t) EXPECT_EQ(harness.Push(video_.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 6u);
  for (std::size_t t = 0; t < out.size(); ++t) {
    EXPECT_EQ(GST_BUFFER_OFFSET(out[t].get()), t + 6);
    EXPECT_EQ(TakeEvidence(out[t].get())->registration.frame_number, t + 6);
  }
}

TEST_F(BackgroundElementTest, AsksForBuffersThatItHolds) {
  Harness harness(Chain(4, 4));
  gst_harness_set_propose_allocator(harness.get(), nullptr, nullptr);
  gst_harness_add_propose_allocation_meta(harness.get(), GST_VIDEO_META_API_TYPE, nullptr);
  gst_harness_add_propose_allocation_meta(harness.get(), GST_VIDEO_CROP_META_API_TYPE, nullptr);
  harness.SetCaps(video_.Caps());
  GstCaps* caps = gst_caps_from_string(video_.Caps().c_str());
  GstQuery* query = gst_query_new_allocation(caps, TRUE);
  GstBufferPool* pool = gst_buffer_pool_new();
  gst_query_add_allocation_pool(query, pool, 100, 2, 5);
  ASSERT_TRUE(gst_pad_peer_query(harness.get()->srcpad, query));
  guint minimum = 0, maximum = 0;
  gst_query_parse_nth_allocation_pool(query, 0, nullptr, nullptr, &minimum, &maximum);
  EXPECT_EQ(minimum, 6u);
  EXPECT_EQ(maximum, 9u);
  EXPECT_FALSE(gst_query_find_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, nullptr));
  gst_object_unref(pool);
  gst_query_unref(query);
  gst_caps_unref(caps);
}

TEST_F(BackgroundElementTest, NeedsRegistration) {
  Harness harness("whbackground device=cpu tile-columns=4 tile-rows=4");
  harness.SetCaps(video_.Caps());
  EXPECT_EQ(harness.Push(video_.Frame(0)), GST_FLOW_ERROR);
  const auto errors = harness.Errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(errors[0].text, testing::HasSubstr("whregister"));
}

TEST_F(BackgroundElementTest, RunsAgainAfterReady) {
  Harness harness(Chain(4, 4));
  GstElement* bin = harness.get()->element;
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  harness.PullAll();
  gst_element_set_state(bin, GST_STATE_READY);
  gst_element_set_state(bin, GST_STATE_PLAYING);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  harness.PushEvent(gst_event_new_stream_start("again"));
  harness.SetCaps(video_.Caps());
  harness.PushEvent(gst_event_new_segment(&segment));
  for (int t = 0; t < 6; ++t) EXPECT_EQ(harness.Push(video_.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 6u);
  EXPECT_EQ(gst_buffer_get_windhover_homography_meta(out[0].get())->registration.frame_number, 0u);
}

}  // namespace
}  // namespace windhover
