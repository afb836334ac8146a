// SPDX-License-Identifier: Apache-2.0
// What all elements have in common, and whmotion and whoverlay.

#include <gmock/gmock.h>
#include <gst/video/video.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "gst-plugins/evidence_meta.h"
#include "service/gstreamer/detection_meta.h"
#include "tests/gst-plugins/harness.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

constexpr int kWidth = 161;
constexpr int kHeight = 121;
constexpr char kAnalysis[] =
    "whregister device=cpu tile-columns=4 tile-rows=4 ! "
    "whbackground device=cpu tile-columns=4 tile-rows=4 k=5 lookahead=5 ! whmotion";

class ManualPageTest : public testing::TestWithParam<const char*> {};

TEST_P(ManualPageTest, SaysWhatThereIsToSay) {
  GstElementFactory* factory = gst_element_factory_find(GetParam());
  ASSERT_NE(factory, nullptr);
  const std::string klass = gst_element_factory_get_metadata(factory, GST_ELEMENT_METADATA_KLASS);
  EXPECT_THAT(klass, testing::MatchesRegex("Filter/(Analyzer|Effect)/Video.*"));
  EXPECT_GT(std::string(gst_element_factory_get_metadata(factory, GST_ELEMENT_METADATA_DESCRIPTION))
                .size(),
            60u);
  EXPECT_EQ(gst_element_factory_get_num_pad_templates(factory), 2u);
  const ElementPtr element = MakeElement(GetParam());
  guint count = 0;
  GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element.get()), &count);
  for (guint i = 0; i < count; ++i) {
    EXPECT_GT(std::string(g_param_spec_get_blurb(specs[i])).size(), 8u) << specs[i]->name;
  }
  g_free(specs);
  gst_object_unref(factory);
}

INSTANTIATE_TEST_SUITE_P(Elements, ManualPageTest,
                         testing::Values("whregister", "whbackground", "whmotion", "whpublish",
                                         "whoverlay", "whstabilize"),
                         [](const auto& info) { return info.param; });

TEST(MotionElement, FindsWhatMovesAndNothingElse) {
  TestVideo video(kWidth, kHeight, GST_VIDEO_FORMAT_I420);
  Harness harness(kAnalysis);
  harness.SetCaps(video.Caps());
  constexpr int kFrames = 30;
  for (int t = 0; t < kFrames; ++t) ASSERT_EQ(harness.Push(video.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), static_cast<std::size_t>(kFrames));
  int found = 0;
  std::vector<Detection> detections;
  for (int t = 0; t < kFrames; ++t) {
    EXPECT_EQ(TakeEvidence(out[t].get()), nullptr) << "whmotion lets it go";
    GetDetections(out[t].get(), kWidth, kHeight, detections);
    const Eigen::Vector2d truth =
        video.ObjectInFrame(t) + Eigen::Vector2d::Constant(0.5 * TestVideo::kObjectSide);
    for (const Detection& detection : detections) {
      const Box& box = detection.box;
      const Eigen::Vector2d centre(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
      EXPECT_LT((centre - truth).norm(), 6.0) << t;
      ++found;
    }
  }
  EXPECT_GT(found, kFrames / 2);
}

TEST(MotionElement, BlackVideoHasNoDetections) {
  TestVideo video(kWidth, kHeight);
  Harness harness(kAnalysis);
  harness.SetCaps(video.Caps());
  for (int t = 0; t < 15; ++t) ASSERT_EQ(harness.Push(video.Black(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 15u);
  for (const BufferPtr& buffer : out) {
    EXPECT_EQ(gst_buffer_get_meta(buffer.get(), GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE),
              nullptr);
  }
}

// The whole chain; detections as of the twin of 8 bits. The overlay draws on 8 bits only.
TEST(Elements, TakeThermalVideo) {
  for (const GstVideoFormat format : {GST_VIDEO_FORMAT_GRAY16_LE, GST_VIDEO_FORMAT_GRAY16_BE}) {
    TestVideo plain(kWidth, kHeight), thermal(kWidth, kHeight, format);
    std::vector<int> detections[2];
    int which = 0;
    for (TestVideo* video : {&plain, &thermal}) {
      Harness harness(kAnalysis);
      harness.SetCaps(video->Caps());
      for (int t = 0; t < 25; ++t) ASSERT_EQ(harness.Push(video->Frame(t)), GST_FLOW_OK);
      harness.PushEvent(gst_event_new_eos());
      EXPECT_TRUE(harness.Errors().empty());
      for (const BufferPtr& buffer : harness.PullAll()) {
        detections[which].push_back(static_cast<int>(
            gst_buffer_get_n_meta(buffer.get(), GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)));
      }
      ++which;
    }
    EXPECT_EQ(detections[1], detections[0]);
    EXPECT_GT(std::count(detections[1].begin(), detections[1].end(), 1), 10);
  }
}

TEST(MotionElement, NeedsBackground) {
  TestVideo video(kWidth, kHeight);
  Harness harness("whregister device=cpu tile-columns=4 tile-rows=4 ! whmotion");
  harness.SetCaps(video.Caps());
  EXPECT_EQ(harness.Push(video.Frame(0)), GST_FLOW_ERROR);
  const auto errors = harness.Errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(errors[0].text, testing::HasSubstr("whbackground"));
}

TEST(OverlayElement, DrawsInPlaceOrOnACopy) {
  TestVideo video(kWidth, kHeight, GST_VIDEO_FORMAT_NV12, Layout::kWithMeta);
  for (const bool shared : {false, true}) {
    Harness harness("whoverlay");
    harness.SetCaps(video.Caps());
    BufferPtr in = video.Frame(0);
    AddDetections(in.get(), {{1, {50.0, 40.0, 20.0, 10.0}, {0.0, 0.0}, 0.9, 5}}, kWidth, kHeight);
    const BufferPtr held(shared ? gst_buffer_ref(in.get()) : nullptr);
    const GstMemory* memory = gst_buffer_peek_memory(in.get(), 0);
    ASSERT_EQ(harness.Push(std::move(in)), GST_FLOW_OK);
    const BufferPtr out = harness.Pull();
    ASSERT_NE(out, nullptr);
    const BufferPtr plain = video.Frame(0);
    GstMapInfo map;
    ASSERT_TRUE(gst_buffer_map(plain.get(), &map, GST_MAP_READ));
    EXPECT_NE(gst_buffer_memcmp(out.get(), 0, map.data, map.size), 0);
    if (shared) {
      EXPECT_EQ(gst_buffer_memcmp(held.get(), 0, map.data, map.size), 0);
    } else {
      EXPECT_EQ(gst_buffer_peek_memory(out.get(), 0), memory);
    }
    gst_buffer_unmap(plain.get(), &map);
  }
}

}  // namespace
}  // namespace windhover
