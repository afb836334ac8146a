// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "service/dds/publisher.h"
#include "service/dds/subscriber.h"
#include "tests/service/dds_fixture.h"
#include "tests/service/dds_samples.h"
#include "tests/support/allocation_count.h"

namespace windhover {
namespace {

using testing::HasSubstr;

TEST_F(DdsTest, CarriesHomographiesExactly) {
  Connect();
  const std::vector<FrameRegistration> sent = {SampleRegistration(0, true),
                                               SampleRegistration(1, false), ExtremeRegistration()};
  for (const FrameRegistration& registration : sent) {
    ASSERT_TRUE(publisher_->Publish(registration, 1921, 1081, INT64_MAX));
  }
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return homographies_.size() == 3; }));
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_TRUE(Same(homographies_[i].registration, sent[i])) << i;
    EXPECT_EQ(homographies_[i].stream, "alpha");
    EXPECT_EQ(homographies_[i].width, 1921);
    EXPECT_EQ(homographies_[i].height, 1081);
    EXPECT_EQ(homographies_[i].pts_ns, INT64_MAX);
    EXPECT_GT(homographies_[i].written_ns, 0);
  }
  EXPECT_EQ(publisher_->counters().homographies, 3);
  EXPECT_EQ(publisher_->counters().failed, 0);
}

TEST_F(DdsTest, CarriesDetectionsExactlyAlsoNoneAndTheMost) {
  Connect();
  std::vector<Detection> all;
  for (int i = 0; i < Publisher::kMaxDetections + 3; ++i) all.push_back(SampleDetection(i + 1));
  all[0].track_id = UINT64_MAX;
  all[0].age_frames = INT32_MAX;
  all[0].box = {-DBL_MAX, DBL_TRUE_MIN, DBL_MAX, -0.0};
  const std::vector<Detection> one(all.begin(), all.begin() + 1);
  ASSERT_TRUE(publisher_->Publish(5, 640, 480, -1, {}));
  ASSERT_TRUE(publisher_->Publish(6, 640, 480, 0, all));
  ASSERT_TRUE(publisher_->Publish(UINT64_MAX, 640, 480, INT64_MIN, one));
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return detections_.size() == 3; }));
  EXPECT_TRUE(detections_[0].detections.empty());
  EXPECT_EQ(detections_[0].frame_number, 5);
  EXPECT_EQ(detections_[0].pts_ns, -1);
  ASSERT_EQ(detections_[1].detections.size(), Publisher::kMaxDetections);
  EXPECT_EQ(detections_[1].omitted, 3);
  for (int i = 0; i < Publisher::kMaxDetections; ++i) {
    EXPECT_TRUE(Same(detections_[1].detections[i], all[i])) << i;
  }
  ASSERT_EQ(detections_[2].detections.size(), 1);
  EXPECT_TRUE(Same(detections_[2].detections[0], all[0]));
  EXPECT_EQ(detections_[2].frame_number, UINT64_MAX);
  EXPECT_EQ(detections_[2].pts_ns, INT64_MIN);
  EXPECT_EQ(detections_[2].omitted, 0);
  EXPECT_EQ(publisher_->counters().detections, 3);
  EXPECT_EQ(publisher_->counters().boxes, Publisher::kMaxDetections + 1);
  EXPECT_EQ(publisher_->counters().omitted, 3);
}

TEST_F(DdsTest, FiltersByStream) {
  subscribe_.stream = "alpha";
  Connect();
  PublishOptions other_options = publish_;
  other_options.stream = "beta";
  MatchCounter other_matches;
  Publisher other(other_options, other_matches.callback());
  ASSERT_TRUE(other_matches.WaitFor(1));
  int publishers = 1;
  handlers_.publishers_changed = [&](int now) { publishers = now; };
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return publishers == 2; }));
  for (int frame = 0; frame < 10; ++frame) {
    ASSERT_TRUE(other.Publish(frame, 8, 8, 0, {}));
    ASSERT_TRUE(publisher_->Publish(frame, 8, 8, 0, {}));
  }
  ASSERT_TRUE(other.End());
  std::thread end([&] { publisher_->End(); });
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return ends_.size() == 2; }));
  end.join();
  EXPECT_EQ(detections_.size(), 10);
  for (const DetectionsSample& sample : detections_) EXPECT_EQ(sample.stream, "alpha");
}

TEST_F(DdsTest, KeepAllLosesNothingOfManyQuickSamples) {
  Connect();
  constexpr int kFrames = 2000;
  std::vector<Detection> boxes;
  for (int i = 0; i < 30; ++i) boxes.push_back(SampleDetection(i + 1));
  std::thread publish([&] {
    for (int frame = 0; frame < kFrames; ++frame) {
      EXPECT_TRUE(publisher_->Publish(SampleRegistration(frame, true), 8, 8, frame));
      EXPECT_TRUE(publisher_->Publish(frame, 8, 8, frame, boxes));
    }
    EXPECT_TRUE(publisher_->End());
  });
  EXPECT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return ends_.size() == 2; }));
  publish.join();
  ASSERT_EQ(homographies_.size(), kFrames);
  ASSERT_EQ(detections_.size(), kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    EXPECT_EQ(homographies_[frame].registration.frame_number, frame);
    EXPECT_EQ(detections_[frame].frame_number, frame);
  }
}

TEST_F(DdsTest, AllocatesNothingOfOursPerSample) {
  Connect();
  std::uint64_t boxes = 0;
  std::uint64_t samples = 0;
  handlers_.homography = [&](const HomographySample&) { ++samples; };
  handlers_.detections = [&](const DetectionsSample& sample) {
    ++samples;
    boxes += sample.detections.size();
  };
  std::vector<Detection> all;
  for (int i = 0; i < 200; ++i) all.push_back(SampleDetection(i + 1));
  const FrameRegistration registration = SampleRegistration(1, true);
  const auto exchange = [&] {
    const std::uint64_t before = samples;
    publisher_->Publish(registration, 8, 8, 0);
    publisher_->Publish(1, 8, 8, 0, all);
    return PollUntil(*subscriber_, handlers_, [&] { return samples == before + 2; });
  };
  ASSERT_TRUE(exchange());
  const std::size_t allocations = AllocationCount();
  ASSERT_GT(allocations, 0);
  for (int frame = 0; frame < 50; ++frame) ASSERT_TRUE(exchange());
  EXPECT_EQ(AllocationCount() - allocations, 0);
  EXPECT_EQ(boxes, 51 * all.size());
}

TEST_F(DdsTest, InterruptEndsAWait) {
  Connect();
  std::thread interrupt([&] { subscriber_->Interrupt(); });
  EXPECT_FALSE(subscriber_->Poll(std::chrono::nanoseconds(-1), handlers_));
  interrupt.join();
  EXPECT_FALSE(subscriber_->Poll(std::chrono::nanoseconds(0), handlers_));
}

// However much there is, one call of Poll hands over little of each topic, so that neither waits
// for the other and an interrupt holds soon.
TEST_F(DdsTest, InterruptEndsALongHandover) {
  Connect();
  constexpr int kFrames = 200;
  for (int frame = 0; frame < kFrames; ++frame) {
    ASSERT_TRUE(publisher_->Publish(SampleRegistration(frame, true), 8, 8, frame));
    ASSERT_TRUE(publisher_->Publish(frame, 8, 8, frame, {}));
  }
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return !homographies_.empty(); }));
  EXPECT_FALSE(detections_.empty());
  EXPECT_LT(homographies_.size(), kFrames / 2);
  EXPECT_LT(detections_.size(), kFrames / 2);
  subscriber_->Interrupt();
  EXPECT_FALSE(subscriber_->Poll(kPatience, handlers_));
  EXPECT_LT(homographies_.size(), kFrames / 2);
  // What is left comes with the next calls.
  EXPECT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return homographies_.size() == kFrames; }));
}

TEST_F(DdsTest, CountsSubscribersOfOnePartition) {
  publish_.partition = partition_ + "," + partition_ + "-own";
  Connect();
  EXPECT_EQ(publisher_->subscribers(), 1);
  EXPECT_EQ(publisher_->subscribers(partition_), 1);
  EXPECT_EQ(publisher_->subscribers(partition_ + "-own"), 0);
  EXPECT_EQ(publisher_->subscribers(""), 0);
  // A reader of one topic alone is none.
  SubscribeOptions half = subscribe_;
  half.partition += "-own";
  half.homographies = false;
  Subscriber first(half);
  SubscribeOptions whole = subscribe_;
  whole.partition = partition_ + "-elsewhere," + partition_ + "-own";
  Subscriber second(whole);
  ASSERT_TRUE(matches_.WaitFor(2));
  EXPECT_EQ(publisher_->subscribers(partition_), 1);
  EXPECT_EQ(publisher_->subscribers(partition_ + "-own"), 1);
  EXPECT_EQ(publisher_->subscribers(partition_ + "-elsewhere"), 1);
}

TEST_F(DdsTest, OtherPartitionsAreNotSeen) {
  Connect();
  PublishOptions other_options = publish_;
  other_options.partition += "-other";
  Publisher other(other_options);
  EXPECT_TRUE(other.Publish(77, 8, 8, 0, {}));
  ASSERT_TRUE(publisher_->Publish(1, 8, 8, 0, {}));
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return !detections_.empty(); }));
  EXPECT_EQ(other.subscribers(), 0);
  ASSERT_EQ(detections_.size(), 1);
  EXPECT_EQ(detections_[0].frame_number, 1);
}

TEST_F(DdsTest, OneOfSeveralPartitionsIsEnough) {
  publish_.partition = "," + partition_ + "-other," + partition_;
  Connect();
  ASSERT_TRUE(publisher_->Publish(1, 8, 8, 0, {}));
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return !detections_.empty(); }));
}

TEST(PublisherTest, PublishesWithoutSubscribers) {
  PublishOptions options;
  options.partition = OwnPartition("without-subscribers");
  options.history_depth = 1;
  Publisher publisher(options);
  for (int frame = 0; frame < 1000; ++frame) EXPECT_TRUE(publisher.Publish(frame, 8, 8, 0, {}));
  EXPECT_EQ(publisher.subscribers(), 0);
  EXPECT_EQ(publisher.counters().detections, 1000);
  EXPECT_TRUE(publisher.End());
}

TEST(PublisherTest, RefusesOptionsOutOfRange) {
  PublishOptions options;
  options.stream = "";
  EXPECT_THROW(Publisher{options}, OptionError);
  options.stream = std::string(65, 'x');
  EXPECT_THROW(Publisher{options}, OptionError);
  options.stream = std::string(64, 'x');
  options.partition = OwnPartition("longest-name");
  EXPECT_NO_THROW(Publisher{options});
  options.domain = 231;
  EXPECT_THROW(Publisher{options}, OptionError);
}

TEST(PublisherTest, SaysWhatIsWrongWithTheConfiguration) {
  setenv("CYCLONEDDS_URI", "<Nonsense><Deep/></Nonsense>", 1);
  try {
    Publisher publisher{PublishOptions{}};
    ADD_FAILURE() << "took it";
  } catch (const DdsError& error) {
    EXPECT_THAT(error.what(), HasSubstr("CYCLONEDDS_URI"));
    EXPECT_THAT(error.what(), HasSubstr("Nonsense"));
  }
  // The next one has no hangover.
  unsetenv("CYCLONEDDS_URI");
  EXPECT_NO_THROW(Publisher{PublishOptions{}});
}

TEST(PublisherTest, TakesTheUsersConfiguration) {
  setenv("CYCLONEDDS_URI",
         "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces>"
         "<AllowMulticast>false</AllowMulticast></General>",
         1);
  EXPECT_NO_THROW(Publisher{PublishOptions{}});
  setenv("CYCLONEDDS_URI",
         "<General><Interfaces><NetworkInterface name=\"nowhere7\"/></Interfaces></General>", 1);
  try {
    Publisher publisher{PublishOptions{}};
    ADD_FAILURE() << "took it";
  } catch (const DdsError& error) {
    EXPECT_THAT(error.what(), HasSubstr("nowhere7"));
  }
  unsetenv("CYCLONEDDS_URI");
}

}  // namespace
}  // namespace windhover
