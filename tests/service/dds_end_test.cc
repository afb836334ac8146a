// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>

#include "service/dds/conversion.h"
#include "service/dds/handles.h"
#include "service/dds/participant.h"
#include "tests/service/dds_fixture.h"
#include "tests/service/dds_samples.h"

// How the end of a stream is told.

namespace windhover {
namespace {

using testing::ElementsAre;

using DdsEndTest = DdsTest;

TEST_F(DdsEndTest, TellsTheEndOnceAfterTheLastSample) {
  Connect();
  for (int frame = 0; frame < 40; ++frame) {
    ASSERT_TRUE(publisher_->Publish(SampleRegistration(frame, true), 8, 8, frame));
    ASSERT_TRUE(publisher_->Publish(frame, 8, 8, frame, {}));
  }
  std::size_t samples_at_end = 0;
  const auto note = handlers_.end;
  handlers_.end = [&](const std::string& stream, Topic topic, Subscriber::EndReason reason) {
    samples_at_end += topic == Topic::kHomography ? homographies_.size() : detections_.size();
    note(stream, topic, reason);
  };
  std::thread end([&] { EXPECT_TRUE(publisher_->End()); });
  EXPECT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return ends_.size() == 2; }));
  end.join();
  EXPECT_EQ(samples_at_end, 80);
  // Nothing follows when the publisher goes.
  publisher_.reset();
  int publishers = 1;
  handlers_.publishers_changed = [&](int now) { publishers = now; };
  EXPECT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return publishers == 0; }));
  std::sort(ends_.begin(), ends_.end());
  EXPECT_THAT(ends_, ElementsAre("alpha detections ended", "alpha homography ended"));
}

TEST_F(DdsEndTest, EndsAStreamWithoutFramesWhenThePublisherGoes) {
  Connect();
  std::thread end([&] { publisher_.reset(); });
  EXPECT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return ends_.size() == 2; }));
  end.join();
}

TEST_F(DdsEndTest, StartsAnewAfterTheEnd) {
  Connect();
  std::thread run([&] {
    for (int round = 0; round < 3; ++round) {
      EXPECT_TRUE(publisher_->Publish(round, 8, 8, 0, {}));
      EXPECT_TRUE(publisher_->End());
    }
  });
  EXPECT_TRUE(PollUntil(*subscriber_, handlers_, [&] {
    return detections_.size() == 3 &&
           std::count(ends_.begin(), ends_.end(), "alpha detections ended") == 3;
  }));
  run.join();
}

// An end is told also where its sample is the last of a whole handover.
TEST_F(DdsEndTest, TellsTheEndAfterAnyNumberOfSamples) {
  Connect();
  std::size_t ended = 0;
  for (int frames = 1; frames <= 64; ++frames) {
    for (int frame = 0; frame < frames; ++frame) {
      ASSERT_TRUE(publisher_->Publish(frame, 8, 8, frame, {}));
    }
    ASSERT_TRUE(publisher_->End());
    ended += 1;
    ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] {
      return static_cast<std::size_t>(
                 std::count(ends_.begin(), ends_.end(), "alpha detections ended")) == ended;
    })) << frames;
  }
}

// The subscriber looks only when the publisher is back again.
TEST_F(DdsEndTest, APublisherThatCameBackWasLost) {
  subscriber_.emplace(subscribe_);
  handlers_.end = [this](const std::string& stream, Topic, Subscriber::EndReason reason) {
    ends_.push_back(stream + (reason == Subscriber::EndReason::kEnded ? " ended" : " lost"));
  };
  handlers_.detections = [this](const DetectionsSample& sample) { detections_.push_back(sample); };
  const Participant participant(0);
  const Entity topic(dds_create_topic(participant.get(), DetectionsDescriptor(), kDetectionsTopic,
                                      nullptr, nullptr),
                     "dds_create_topic");
  const Qos qos = MakeQos(true, 1000, 0, partition_);
  DetectionsMessage message("alpha");
  int publishers = 0;
  handlers_.publishers_changed = [&](int now) { publishers = now; };
  for (int life = 0; life < 2; ++life) {
    const Entity writer(dds_create_writer(participant.get(), topic.get(), qos.get(), nullptr),
                        "dds_create_writer");
    message.Set(static_cast<std::uint64_t>(life), 8, 8, 0, {});
    ASSERT_EQ(dds_write(writer.get(), message.data()), DDS_RETCODE_OK);
  }
  ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return ends_.size() == 2; }));
  EXPECT_EQ(detections_.size(), 2);
  EXPECT_THAT(ends_, ElementsAre("alpha lost", "alpha lost"));
}

}  // namespace
}  // namespace windhover
