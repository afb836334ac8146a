// SPDX-License-Identifier: Apache-2.0
// The bus between two processes: a publisher here, `windhover watch` there.

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "service/dds/publisher.h"
#include "tests/service/app_process.h"
#include "tests/service/dds_samples.h"

namespace windhover {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kMatched = "{\"type\":\"publishers\",\"publishers\":1}";

class WatchTest : public testing::Test {
 protected:
  WatchTest() {
    unsetenv("CYCLONEDDS_URI");
    options_.stream = "alpha";
    options_.partition = partition_;
    options_.history_depth = 0;
    options_.max_blocking_ms = 20000;
  }

  std::vector<std::string> Command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command = {WINDHOVER_EXECUTABLE, "watch", "--partition", partition_};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }

  // Starts `windhover watch` and waits until each side knows of the other.
  void Connect(const std::vector<std::string>& arguments) {
    publisher_.emplace(options_, [this](int subscribers) {
      const std::lock_guard lock(mutex_);
      subscribers_ = subscribers;
      changed_.notify_all();
    });
    watch_.emplace(Command(arguments));
    first_line_ = watch_->ReadLine().value_or("");
    std::unique_lock lock(mutex_);
    ASSERT_TRUE(changed_.wait_for(lock, std::chrono::seconds(60), [&] {
      return subscribers_ == 1;
    })) << watch_->ErrorText();
  }

  void PublishFrame(std::uint64_t frame, const std::vector<Detection>& detections = {}) {
    const auto pts_ns = static_cast<std::int64_t>(frame) * 40'000'000;
    EXPECT_TRUE(publisher_->Publish(SampleRegistration(frame, true), 640, 480, pts_ns));
    EXPECT_TRUE(publisher_->Publish(frame, 640, 480, pts_ns, detections));
  }

  // The objects of that type among the lines.
  static std::vector<Json> OfType(const std::vector<std::string>& lines, const std::string& type) {
    std::vector<Json> found;
    for (const std::string& line : lines) {
      Json json = Json::parse(line);
      if (json["type"] == type) found.push_back(std::move(json));
    }
    return found;
  }

  const std::string partition_ =
      OwnPartition(testing::UnitTest::GetInstance()->current_test_info()->name());
  PublishOptions options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int subscribers_ = 0;
  std::optional<Publisher> publisher_;
  std::optional<Process> watch_;
  std::string first_line_;
};

TEST_F(WatchTest, ValuesSurviveExactly) {
  Connect({"--json", "--until-end"});
  EXPECT_EQ(first_line_, kMatched);
  const FrameRegistration extreme = ExtremeRegistration();
  std::vector<Detection> most;
  for (int i = 0; i < Publisher::kMaxDetections; ++i) most.push_back(SampleDetection(i + 1));
  ASSERT_TRUE(publisher_->Publish(extreme, 1, 2, INT64_MAX));
  ASSERT_TRUE(publisher_->Publish(UINT64_MAX, 1, 2, INT64_MAX, most));
  ASSERT_TRUE(publisher_->Publish(0, 1, 2, -1, {}));
  ASSERT_TRUE(publisher_->End());
  const std::vector<std::string> lines = watch_->ReadLines();
  EXPECT_EQ(watch_->Wait(), 0);

  const std::vector<Json> homographies = OfType(lines, "homography");
  ASSERT_EQ(homographies.size(), 1);
  const Json& homography = homographies[0];
  EXPECT_EQ(homography["frame"], UINT64_MAX);
  EXPECT_EQ(homography["anchor"], UINT64_MAX - 1);
  EXPECT_EQ(homography["pts_ns"], INT64_MAX);
  EXPECT_EQ(homography["residual_px"], extreme.residual_px);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(homography["previous_from_frame"][i], extreme.previous_from_frame(i / 3, i % 3));
  }
  for (int i = 0; i < 64; ++i) {
    EXPECT_EQ(homography["corner_covariance_px2"][i], extreme.corner_covariance(i / 8, i % 8));
  }

  const std::vector<Json> frames = OfType(lines, "detections");
  ASSERT_EQ(frames.size(), 2);
  ASSERT_EQ(frames[0]["detections"].size(), most.size());
  for (std::size_t i = 0; i < most.size(); ++i) {
    const Json& json = frames[0]["detections"][i];
    Detection received;
    received.track_id = json["track"];
    received.box = {json["x"], json["y"], json["width"], json["height"]};
    received.velocity_px.x() = json["velocity_x_px"];
    received.velocity_px.y() = json["velocity_y_px"];
    received.score = json["score"];
    received.age_frames = json["age_frames"];
    EXPECT_TRUE(Same(received, most[i])) << i;
  }
  EXPECT_THAT(frames[1]["detections"], IsEmpty());
  EXPECT_TRUE(frames[1]["pts_ns"].is_null());

  const std::vector<Json> ends = OfType(lines, "end");
  ASSERT_EQ(ends.size(), 2);
  for (const Json& end : ends) {
    EXPECT_EQ(end["stream"], "alpha");
    EXPECT_EQ(end["reason"], "ended");
  }
}

TEST_F(WatchTest, KeepAllLosesNothingOfManyQuickSamples) {
  Connect({"--json", "--until-end"});
  constexpr std::uint64_t kFrames = 2000;
  std::vector<Detection> detections;
  for (int i = 0; i < 20; ++i) detections.push_back(SampleDetection(i + 1));
  std::thread publish([&] {
    for (std::uint64_t frame = 0; frame < kFrames; ++frame) PublishFrame(frame, detections);
    EXPECT_TRUE(publisher_->End());
  });
  const std::vector<std::string> lines = watch_->ReadLines();
  publish.join();
  EXPECT_EQ(watch_->Wait(), 0);
  for (const char* type : {"homography", "detections"}) {
    const std::vector<Json> samples = OfType(lines, type);
    ASSERT_EQ(samples.size(), kFrames) << type;
    for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
      ASSERT_EQ(samples[frame]["frame"], frame) << type;
    }
  }
  EXPECT_EQ(publisher_->counters().failed, 0);
}

// What comes is there at once, not when a buffer is full.
TEST_F(WatchTest, PrintsEachLineAtOnce) {
  Connect({"--json"});
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    PublishFrame(frame);
    for (int topic = 0; topic < 2; ++topic) {
      const auto line = watch_->ReadLine();
      ASSERT_TRUE(line.has_value());
      EXPECT_EQ(Json::parse(*line)["frame"], frame);
    }
  }
  watch_->Signal(SIGINT);
  EXPECT_EQ(watch_->ReadLine(), std::nullopt);
  EXPECT_EQ(watch_->Wait(), 0);
}

TEST_F(WatchTest, PrintsForPeople) {
  Connect({"--count", "2"});
  EXPECT_EQ(first_line_, "1 publisher");
  PublishFrame(12, {SampleDetection(4)});
  const std::vector<std::string> lines = watch_->ReadLines();
  EXPECT_EQ(watch_->Wait(), 0);
  EXPECT_THAT(lines, testing::UnorderedElementsAre(
                         HasSubstr("alpha frame 12 at 0.480 s: homography valid"),
                         HasSubstr("alpha frame 12 at 0.480 s: 1 detections: #4")));
}

TEST_F(WatchTest, OneTopicAlone) {
  options_.history_depth = 1;
  publisher_.emplace(options_);
  watch_.emplace(Command({"--json", "--topics", "homography", "--until-end"}));
  ASSERT_EQ(watch_->ReadLine(), kMatched);
  // The publisher counts subscribers of both topics only, so it publishes until something arrives.
  std::atomic<bool> arrived = false;
  std::thread publish([&] {
    for (std::uint64_t frame = 0; !arrived; ++frame) PublishFrame(frame);
    EXPECT_TRUE(publisher_->End());
  });
  const auto first = watch_->ReadLine();
  arrived = true;
  std::vector<std::string> lines = watch_->ReadLines();
  publish.join();
  EXPECT_EQ(watch_->Wait(), 0);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(Json::parse(*first)["type"], "homography");
  EXPECT_THAT(OfType(lines, "detections"), IsEmpty());
  EXPECT_EQ(OfType(lines, "end").size(), 1);
}

TEST_F(WatchTest, OneStreamAlone) {
  Connect({"--json", "--stream", "beta", "--until-end"});
  PublishOptions beta_options = options_;
  beta_options.stream = "beta";
  // The subscriber is known to the first publisher; the second finds it by itself.
  std::mutex mutex;
  std::condition_variable changed;
  int subscribers = 0;
  Publisher beta(beta_options, [&](int now) {
    const std::lock_guard lock(mutex);
    subscribers = now;
    changed.notify_all();
  });
  {
    std::unique_lock lock(mutex);
    ASSERT_TRUE(changed.wait_for(lock, std::chrono::seconds(60), [&] { return subscribers == 1; }));
  }
  ASSERT_EQ(watch_->ReadLine(), "{\"type\":\"publishers\",\"publishers\":2}");
  PublishFrame(0);
  ASSERT_TRUE(publisher_->End());
  EXPECT_TRUE(beta.Publish(7, 640, 480, 0, {}));
  EXPECT_TRUE(beta.End());
  const std::vector<std::string> lines = watch_->ReadLines();
  EXPECT_EQ(watch_->Wait(), 0);
  const std::vector<Json> frames = OfType(lines, "detections");
  ASSERT_EQ(frames.size(), 1);
  EXPECT_EQ(frames[0]["stream"], "beta");
  EXPECT_THAT(OfType(lines, "homography"), IsEmpty());
}

TEST_F(WatchTest, ClosedOutputIsACleanEnd) {
  Connect({"--json"});
  watch_->CloseOutput();
  PublishFrame(0);
  EXPECT_EQ(watch_->Wait(), 0);
  EXPECT_THAT(watch_->ErrorText(), testing::Not(HasSubstr("windhover:")));
}

// A subscriber that stands still holds the end up for little longer than one wait, and it shows.
TEST_F(WatchTest, AnEndThatCannotBeToldIsNotTold) {
  options_.max_blocking_ms = 500;
  Connect({"--json"});
  watch_->Signal(SIGSTOP);
  const std::vector<Detection> most(Publisher::kMaxDetections, SampleDetection(1));
  while (publisher_->Publish(0, 640, 480, 0, most)) {
  }
  while (publisher_->Publish(SampleRegistration(0, true), 640, 480, 0)) {
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(publisher_->End());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(1500));
  EXPECT_FALSE(publisher_->End()) << "it has not been told since";
}

TEST_F(WatchTest, InterruptBeforeTheEndSaysSo) {
  Connect({"--json", "--until-end"});
  PublishFrame(0);
  ASSERT_TRUE(watch_->ReadLine().has_value());
  watch_->Signal(SIGTERM);
  EXPECT_EQ(watch_->Wait(), 130);
}

// A publisher whose process dies is noticed when its lease ends.
TEST_F(WatchTest, SeesThatAPublisherIsLost) {
  const std::string loopback =
      "CYCLONEDDS_URI=<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/>"
      "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
      "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>100"
      "</MaxAutoParticipantIndex><Peers><Peer address=\"localhost\"/></Peers>"
      "<LeaseDuration>1s</LeaseDuration></Discovery>";
  Process watch(Command({"--json", "--until-end"}), {loopback});
  Process publisher({DDS_PUBLISH_FOREVER, partition_}, {loopback});
  ASSERT_EQ(watch.ReadLine(), kMatched);
  ASSERT_TRUE(watch.ReadLine().has_value());
  ASSERT_TRUE(watch.ReadLine().has_value());
  publisher.Signal(SIGKILL);
  const std::vector<std::string> lines = watch.ReadLines();
  EXPECT_EQ(watch.Wait(), 1);
  const std::vector<Json> ends = OfType(lines, "end");
  ASSERT_EQ(ends.size(), 2);
  for (const Json& end : ends) EXPECT_EQ(end["reason"], "lost");
  EXPECT_THAT(watch.ErrorText(), HasSubstr("without having ended"));
}

TEST_F(WatchTest, SaysHowToOpenTheBusToANetwork) {
  Connect({"--json"});
  EXPECT_THAT(watch_->ErrorText(), HasSubstr("set CYCLONEDDS_URI"));
  watch_->Signal(SIGINT);
  EXPECT_EQ(watch_->Wait(), 0);
}

TEST(WatchCommandTest, RefusesWhatItDoesNotKnow) {
  const auto refused = [](const std::vector<std::string>& arguments, int exit_code,
                          const std::string& text) {
    std::vector<std::string> command = {WINDHOVER_EXECUTABLE, "watch"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const Outcome outcome = RunToEnd(command);
    EXPECT_EQ(outcome.exit_code, exit_code) << text;
    EXPECT_THAT(outcome.errors, HasSubstr(text));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_THAT(outcome.lines, IsEmpty());
  };
  refused({"--domain", "231"}, 2, "231");
  refused({"--topics", "pictures"}, 2, "pictures");
  refused({"--count", "0"}, 2, "--count");
  refused({"--nonsense"}, 2, "--nonsense");
}

TEST(WatchCommandTest, SaysWhatIsWrongWithTheConfiguration) {
  const Outcome outcome = RunToEnd({WINDHOVER_EXECUTABLE, "watch", "--json"},
                                   {"CYCLONEDDS_URI=<General><Nonsense/></General>"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("CYCLONEDDS_URI"));
  EXPECT_THAT(outcome.errors, HasSubstr("Nonsense"));
}

}  // namespace
}  // namespace windhover
