// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "service/dds/publisher.h"
#include "service/dds/subscriber.h"
#include "tests/service/dds_samples.h"

namespace windhover {

inline constexpr auto kPatience = std::chrono::seconds(60);

// Polls until the condition holds; false where it does not come true.
template <typename Condition>
bool PollUntil(Subscriber& subscriber, const Subscriber::Handlers& handlers, Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= left.zero()) return false;
    subscriber.Poll(left, handlers);
  }
  return true;
}

// Counts what Publisher says about its subscribers.
class MatchCounter {
 public:
  Publisher::SubscribersChanged callback() {
    return [this](int subscribers) {
      const std::lock_guard lock(mutex_);
      subscribers_ = subscribers;
      changed_.notify_all();
    };
  }
  bool WaitFor(int subscribers) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return subscribers_ == subscribers; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int subscribers_ = 0;
};

// A publisher and a subscriber that know each other, in a partition of their own.
class DdsTest : public testing::Test {
 protected:
  DdsTest() {
    unsetenv("CYCLONEDDS_URI");
    publish_.partition = partition_;
    publish_.stream = "alpha";
    publish_.max_blocking_ms = 20000;
    publish_.history_depth = 0;
    subscribe_.partition = partition_;
  }

  void Connect() {
    subscriber_.emplace(subscribe_);
    publisher_.emplace(publish_, matches_.callback());
    int publishers = 0;
    handlers_.publishers_changed = [&](int now) { publishers = now; };
    ASSERT_TRUE(PollUntil(*subscriber_, handlers_, [&] { return publishers == 1; }));
    ASSERT_TRUE(matches_.WaitFor(1));
    ASSERT_EQ(publisher_->subscribers(), 1);
    handlers_.publishers_changed = nullptr;
    handlers_.homography = [this](const HomographySample& sample) {
      homographies_.push_back(sample);
    };
    handlers_.detections = [this](const DetectionsSample& sample) {
      detections_.push_back(sample);
    };
    handlers_.end = [this](const std::string& stream, Topic topic, Subscriber::EndReason reason) {
      ends_.push_back(stream + (topic == Topic::kHomography ? " homography" : " detections") +
                      (reason == Subscriber::EndReason::kEnded ? " ended" : " lost"));
    };
  }

  const std::string partition_ =
      OwnPartition(testing::UnitTest::GetInstance()->current_test_info()->name());
  PublishOptions publish_;
  SubscribeOptions subscribe_;
  MatchCounter matches_;
  std::optional<Publisher> publisher_;
  std::optional<Subscriber> subscriber_;
  Subscriber::Handlers handlers_;
  std::vector<HomographySample> homographies_;
  std::vector<DetectionsSample> detections_;
  std::vector<std::string> ends_;
};

}  // namespace windhover
