// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "service/dds/subscriber.h"
#include "tests/gst-plugins/harness.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

constexpr int kWidth = 161;
constexpr int kHeight = 121;

// Other runs of this test on the same machine must not meet.
std::string StreamName() { return "gst-test-" + std::to_string(getpid()); }

std::string Chain() {
  return "whregister device=cpu tile-columns=4 tile-rows=4 ! "
         "whbackground device=cpu tile-columns=4 tile-rows=4 k=5 lookahead=5 ! whmotion ! "
         "whpublish name=publish stream=" +
         StreamName();
}

guint64 Counter(GstElement* element, const char* name) {
  guint64 value = 0;
  g_object_get(element, name, &value, nullptr);
  return value;
}

TEST(PublishElement, EveryFrameReachesASubscriber) {
  TestVideo video(kWidth, kHeight);
  Harness harness(Chain());
  GstElement* publish = harness.Find("publish");
  SubscribeOptions options;
  options.stream = StreamName();
  Subscriber subscriber(options);

  std::vector<HomographySample> homographies;
  std::vector<DetectionsSample> detections;
  int ends = 0;
  Subscriber::Handlers handlers;
  handlers.homography = [&](const HomographySample& s) { homographies.push_back(s); };
  handlers.detections = [&](const DetectionsSample& s) { detections.push_back(s); };
  handlers.end = [&](const std::string&, Topic, Subscriber::EndReason) { ++ends; };
  const auto subscribers = [&] {
    int value = 0;
    g_object_get(publish, "subscribers", &value, nullptr);
    return value;
  };
  while (subscribers() == 0) ASSERT_TRUE(subscriber.Poll(std::chrono::seconds(10), handlers));

  harness.SetCaps(video.Caps());
  constexpr std::size_t kFrames = 20;
  for (std::size_t t = 0; t < kFrames; ++t) harness.Push(video.Frame(static_cast<int>(t)));
  harness.PushEvent(gst_event_new_eos());
  EXPECT_EQ(harness.PullAll().size(), kFrames);
  EXPECT_EQ(Counter(publish, "published-homographies"), kFrames);
  EXPECT_EQ(Counter(publish, "published-detections"), kFrames);
  EXPECT_EQ(Counter(publish, "failed-samples"), 0u);
  EXPECT_GT(Counter(publish, "published-boxes"), 0u);

  while (ends < 2) ASSERT_TRUE(subscriber.Poll(std::chrono::seconds(10), handlers));
  ASSERT_EQ(homographies.size(), kFrames);
  ASSERT_EQ(detections.size(), kFrames);
  std::size_t boxes = 0;
  for (std::size_t t = 0; t < kFrames; ++t) {
    EXPECT_EQ(homographies[t].registration.frame_number, t);
    EXPECT_EQ(detections[t].frame_number, t);
    const auto pts = static_cast<std::int64_t>(TestVideo::kFirstPts + t * TestVideo::kFrameTime);
    EXPECT_EQ(homographies[t].pts_ns, pts);
    EXPECT_EQ(detections[t].pts_ns, pts);
    EXPECT_EQ(homographies[t].width, kWidth);
    boxes += detections[t].detections.size();
  }
  EXPECT_EQ(boxes, Counter(publish, "published-boxes"));
  gst_object_unref(publish);
}

TEST(PublishElement, CountersOutliveThePublisher) {
  TestVideo video(kWidth, kHeight);
  Harness harness(Chain());
  GstElement* publish = harness.Find("publish");
  harness.SetCaps(video.Caps());
  for (int t = 0; t < 3; ++t) harness.Push(video.Frame(t));
  harness.PushEvent(gst_event_new_eos());
  gst_element_set_state(harness.get()->element, GST_STATE_NULL);
  EXPECT_EQ(Counter(publish, "published-homographies"), 3u);
  gst_object_unref(publish);
}

TEST(PublishElement, BadOptionIsAnErrorAtTheStart) {
  const ElementPtr pipeline = MakePipeline("whpublish stream=\"\" ! fakesink");
  EXPECT_EQ(gst_element_set_state(pipeline.get(), GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  GstBus* bus = gst_element_get_bus(pipeline.get());
  std::vector<std::string> errors;
  TakeMessages(bus, GST_MESSAGE_ERROR, [&](GstMessage* message) {
    GError* error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    errors.emplace_back(error->message);
    g_clear_error(&error);
  });
  gst_object_unref(bus);
  EXPECT_THAT(errors, testing::ElementsAre(testing::HasSubstr("stream")));
}

TEST(PublishElement, OptionsMayChangeInReady) {
  const ElementPtr publish = MakeElement("whpublish");
  ASSERT_EQ(gst_element_set_state(publish.get(), GST_STATE_READY), GST_STATE_CHANGE_SUCCESS);
  g_object_set(publish.get(), "partition", StreamName().c_str(), nullptr);
  ASSERT_EQ(gst_element_set_state(publish.get(), GST_STATE_PAUSED), GST_STATE_CHANGE_SUCCESS);
  SubscribeOptions options;
  options.partition = StreamName();
  Subscriber subscriber(options);
  int value = 0;
  while (value == 0) {
    ASSERT_TRUE(subscriber.Poll(std::chrono::seconds(10), {}));
    g_object_get(publish.get(), "subscribers", &value, nullptr);
  }
}

TEST(PublishElement, CountsTheSubscribersOfAPartition) {
  const ElementPtr publish = MakeElement("whpublish");
  const auto subscribers_in = [&](const std::string& partition) {
    int value = -1;
    g_signal_emit_by_name(publish.get(), "subscribers-in", partition.c_str(), &value);
    return value;
  };
  EXPECT_EQ(subscribers_in(StreamName()), 0);
  g_object_set(publish.get(), "partition", ("," + StreamName()).c_str(), nullptr);
  ASSERT_EQ(gst_element_set_state(publish.get(), GST_STATE_READY), GST_STATE_CHANGE_SUCCESS);
  EXPECT_EQ(subscribers_in(StreamName()), 0);
  SubscribeOptions options;
  options.partition = StreamName();
  Subscriber subscriber(options);
  while (subscribers_in(StreamName()) == 0) {
    ASSERT_TRUE(subscriber.Poll(std::chrono::seconds(10), {}));
  }
  EXPECT_EQ(subscribers_in(StreamName()), 1);
  EXPECT_EQ(subscribers_in(StreamName() + "-other"), 0);
}

// Without a publisher there must be no way to frames.
TEST(PublishElement, BadOptionInReadyIsAnErrorEachTime) {
  const ElementPtr publish = MakeElement("whpublish");
  ASSERT_EQ(gst_element_set_state(publish.get(), GST_STATE_READY), GST_STATE_CHANGE_SUCCESS);
  g_object_set(publish.get(), "stream", "", nullptr);
  EXPECT_EQ(gst_element_set_state(publish.get(), GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  EXPECT_EQ(gst_element_set_state(publish.get(), GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  g_object_set(publish.get(), "stream", StreamName().c_str(), nullptr);
  EXPECT_EQ(gst_element_set_state(publish.get(), GST_STATE_PAUSED), GST_STATE_CHANGE_SUCCESS);
}

TEST(PublishElement, NeedsRegistration) {
  TestVideo video(kWidth, kHeight);
  Harness harness("whpublish stream=" + StreamName());
  harness.SetCaps(video.Caps());
  EXPECT_EQ(harness.Push(video.Frame(0)), GST_FLOW_ERROR);
  const auto errors = harness.Errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(errors[0].text, testing::HasSubstr("whregister"));
}

}  // namespace
}  // namespace windhover
