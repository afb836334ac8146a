// SPDX-License-Identifier: Apache-2.0
#include "service/app/run.h"

#include <glib-unix.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "service/app/exit_code.h"
#include "service/app/pending_file.h"
#include "service/app/progress.h"
#include "service/app/random_name.h"
#include "service/app/run_outcome.h"
#include "service/app/subscriber_process.h"
#include "service/dds/log.h"
#include "service/gstreamer/messages.h"
#include "service/gstreamer/pipeline.h"
#include "service/gstreamer/start.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

// Longest wait until publisher and subscriber have found each other, and, at the end, until the
// subscriber has got everything.
constexpr auto kLongestWait = seconds(30);
// A source that gives no frame for so long after an interrupt is stopped by force.
constexpr auto kStandstill = seconds(2);

class GlibLoop {
 public:
  GlibLoop() : loop_(g_main_loop_new(nullptr, FALSE)) {}
  GlibLoop(const GlibLoop&) = delete;
  GlibLoop& operator=(const GlibLoop&) = delete;
  ~GlibLoop() { g_main_loop_unref(loop_); }
  void Run() { g_main_loop_run(loop_); }
  void Quit() { g_main_loop_quit(loop_); }

 private:
  GMainLoop* loop_;
};

// One run. All but the pipeline's streaming threads happens on the main loop of one thread.
class Job {
 public:
  Job(const RunOptions& options, const Source& source);
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job();

  int Run();

 private:
  // What comes next.
  enum class Stage {
    kMatching,  // publisher and subscriber find each other
    kFlowing,   // frames
    kEnding,    // the subscriber gets the last samples and ends
  };

  void Configure(const RunOptions& options);
  void StartSubscriber();
  std::string Setting(const std::string& name, const std::string& otherwise) const;

  // From the main loop.
  void OnMessage(GstMessage* message);
  void OnLine(std::string_view line);
  void OnSubscriberExit(int status);
  void OnInterrupt();
  void OnTick();

  void PlayOnceMatched();
  void EndOfVideo();
  void Fail(const std::string& text);
  int Finish();
  RunOutcome Outcome() const;
  // From the first frame on.
  double FramesPerSecond(Clock::time_point until) const;

  const Source& source_;
  std::vector<OptionSetting> settings_;
  // Only our own subscriber reads in this partition, so it sees this publisher and no other.
  const std::string partition_ = "windhover-run-" + RandomName();
  PendingFile lines_path_;
  std::optional<PendingFile> video_path_;
  std::ofstream lines_;
  GlibLoop loop_;
  std::optional<Pipeline> pipeline_;
  std::optional<SubscriberProcess> subscriber_;
  std::vector<guint> sources_;
  Progress progress_;

  Stage stage_ = Stage::kMatching;
  Clock::time_point stage_start_ = Clock::now();
  bool subscriber_ready_ = false;
  bool subscriber_ended_ = false;
  std::string device_;  // that the elements compute on, for people
  RunOutcome::Samples published_;
  RunOutcome::Samples received_;
  std::uint64_t failed_ = 0;
  Clock::time_point end_of_video_;
  std::string error_;
  bool interrupted_ = false;
  Clock::time_point interrupted_at_;
};

Job::Job(const RunOptions& options, const Source& source)
    : source_(source),
      settings_(options.settings),
      lines_path_(fs::path(options.out) / "detections.jsonl") {
  fs::create_directories(options.out);
  lines_.open(lines_path_.temporary(), std::ios::binary);
  if (!lines_) throw std::runtime_error(options.out + ": cannot be written to");
  if (options.video) video_path_.emplace(fs::path(options.out) / "annotated.mp4");
  pipeline_.emplace(source,
                    std::vector<std::string>{"whregister", "queue", "whbackground", "queue",
                                             "whmotion", "whpublish", "whoverlay"},
                    video_path_ ? video_path_->temporary().string() : "");
  Configure(options);
}

Job::~Job() {
  for (const guint source : sources_) g_source_remove(source);
}

void Job::Configure(const RunOptions& options) {
  std::string stream = source_.stem.substr(0, 64);
  if (stream.empty()) stream = "default";
  // Nothing may be lost, even where the subscriber stops for a while.
  std::vector<OptionSetting> all = {
      {"stream", stream}, {"history-depth", "0"}, {"max-blocking", "20000"}};
  if (!options.device.empty()) all.push_back({"device", options.device});
  all.insert(all.end(), settings_.begin(), settings_.end());
  settings_ = std::move(all);
  settings_.push_back({"partition", Setting("partition", "") + "," + partition_});
  for (const OptionSetting& setting : settings_) pipeline_->Set(setting.name, setting.value);
}

std::string Job::Setting(const std::string& name, const std::string& otherwise) const {
  const auto found = std::find_if(settings_.rbegin(), settings_.rend(),
                                  [&](const OptionSetting& one) { return one.name == name; });
  return found != settings_.rend() ? found->value : otherwise;
}

void Job::StartSubscriber() {
  std::vector<std::string> arguments = {
      "watch",    "--json",   "--until-end",          "--partition",
      partition_, "--domain", Setting("domain", "0"), "--log-level",
      "warn"};
  if (Setting("reliable", "true") == "false") arguments.push_back("--best-effort");
  subscriber_.emplace(
      arguments, [this](std::string_view line) { OnLine(line); },
      [this](int status) { OnSubscriberExit(status); });
}

int Job::Run() {
  const auto tick = [](gpointer self) -> gboolean {
    static_cast<Job*>(self)->OnTick();
    return G_SOURCE_CONTINUE;
  };
  const auto interrupt = [](gpointer self) -> gboolean {
    static_cast<Job*>(self)->OnInterrupt();
    return G_SOURCE_CONTINUE;
  };
  const auto message = [](GstBus*, GstMessage* message, gpointer self) -> gboolean {
    static_cast<Job*>(self)->OnMessage(message);
    return G_SOURCE_CONTINUE;
  };
  sources_ = {g_unix_signal_add(SIGINT, interrupt, this),
              g_unix_signal_add(SIGTERM, interrupt, this), g_timeout_add(100, tick, this),
              gst_bus_add_watch(pipeline_->bus(), message, this)};
  pipeline_->SetState(GST_STATE_READY);
  StartSubscriber();
  loop_.Run();
  progress_.Clear();
  pipeline_->SetState(GST_STATE_NULL);
  return Finish();
}

void Job::OnMessage(GstMessage* message) {
  switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_ERROR: {
      const std::uint64_t frames = pipeline_->frames_in();
      Fail(fmt::format("{}: {}{}", source_.name, TextOf(message),
                       frames > 0 ? fmt::format(" (after {} frames)", frames) : ""));
      break;
    }
    case GST_MESSAGE_WARNING:
      progress_.Clear();
      Log()->warn("{}", TextOf(message));
      break;
    case GST_MESSAGE_EOS:
      EndOfVideo();
      break;
    case GST_MESSAGE_ELEMENT:
      if (gst_message_has_name(message, "windhover-subscribers")) PlayOnceMatched();
      break;
    case GST_MESSAGE_HAVE_CONTEXT:
      device_ = DeviceOf(message).value_or(device_);
      break;
    default:
      break;
  }
}

// The type is the first field of each line; see README.md.
void Job::OnLine(std::string_view line) {
  if (line.starts_with(R"({"type":"detections")")) {
    ++received_.detections;
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object()) received_.boxes += json.value("detections", nlohmann::json()).size();
    lines_ << line << '\n';
    if (!lines_) Fail("detections.jsonl cannot be written: is there room left?");
  } else if (line.starts_with(R"({"type":"homography")")) {
    ++received_.homographies;
  } else if (line.starts_with(R"({"type":"publishers")")) {
    subscriber_ready_ = true;
    PlayOnceMatched();
  }
}

// It ends with the stream on the bus; the encoder may still have work then.
void Job::OnSubscriberExit(int status) {
  subscriber_ended_ = true;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != kExitOk) {
    Fail("The subscriber has failed");
  } else if (stage_ == Stage::kMatching) {
    Fail("The subscriber has ended before the first frame");
  } else if (stage_ == Stage::kEnding) {
    loop_.Quit();
  }
}

void Job::PlayOnceMatched() {
  if (stage_ != Stage::kMatching || !subscriber_ready_ || pipeline_->Subscribers(partition_) == 0) {
    return;
  }
  stage_ = Stage::kFlowing;
  stage_start_ = Clock::now();
  pipeline_->SetState(GST_STATE_PLAYING);
}

void Job::EndOfVideo() {
  if (stage_ != Stage::kFlowing) return;
  end_of_video_ = Clock::now();
  published_ = {pipeline_->Published("published-homographies"),
                pipeline_->Published("published-detections"),
                pipeline_->Published("published-boxes")};
  failed_ = pipeline_->Published("failed-samples");
  stage_ = Stage::kEnding;
  stage_start_ = end_of_video_;
  // Ends the stream on the bus, and with it the subscriber.
  pipeline_->SetState(GST_STATE_NULL);
  if (subscriber_ended_) loop_.Quit();
}

// Before the first frame there is nothing that could come to a clean end, and some sources would
// not end at all.
void Job::OnInterrupt() {
  const bool again = std::exchange(interrupted_, true);
  if (again || stage_ != Stage::kFlowing || pipeline_->frames_in() == 0) {
    Fail(source_.name + ": interrupted");
  } else {
    pipeline_->EndEarly();
    interrupted_at_ = Clock::now();
  }
}

void Job::OnTick() {
  const auto now = Clock::now();
  if (stage_ == Stage::kFlowing) {
    if (interrupted_ && now - interrupted_at_ > kStandstill) pipeline_->EndEarly();
    std::string share;
    if (const SourceReach reach = pipeline_->reach(); reach.length_ns > 0) {
      share =
          fmt::format(", {:.0f} %", std::min(100.0, 100.0 * reach.reached_ns / reach.length_ns));
    }
    progress_.Show(fmt::format("{}: {} frames{}, {:.1f} frames/s", source_.name,
                               pipeline_->frames_out(), share, FramesPerSecond(now)),
                   now);
  } else if (now - stage_start_ > kLongestWait) {
    Fail(stage_ == Stage::kMatching ? "Publisher and subscriber do not find each other on the bus"
                                    : "The subscriber does not come to its end");
  }
}

void Job::Fail(const std::string& text) {
  if (error_.empty()) error_ = text;
  loop_.Quit();
}

double Job::FramesPerSecond(Clock::time_point until) const {
  const double elapsed = std::chrono::duration<double>(until - pipeline_->first_frame()).count();
  return elapsed > 0.0 ? static_cast<double>(pipeline_->frames_out()) / elapsed : 0.0;
}

RunOutcome Job::Outcome() const {
  RunOutcome outcome;
  outcome.source = source_.name;
  outcome.source_reach = pipeline_->reach();
  outcome.frames_out = pipeline_->frames_out();
  outcome.published = published_;
  outcome.received = received_;
  outcome.failed_samples = failed_;
  outcome.frames_per_second = FramesPerSecond(end_of_video_);
  outcome.device = device_;
  return outcome;
}

int Job::Finish() {
  if (!error_.empty()) {
    if (!interrupted_) throw std::runtime_error(error_);
    fmt::print(stderr, "windhover: {}\n", error_);
    return kExitInterrupted;
  }
  if (pipeline_->frames_in() == 0) {
    throw std::runtime_error(source_.name + ": there is no frame in it");
  }
  const RunOutcome outcome = Outcome();
  const std::string loss = Loss(outcome);
  if (loss.empty()) {
    lines_.close();
    if (!lines_) throw std::runtime_error("detections.jsonl cannot be written");
    lines_path_.Complete();
    if (video_path_) video_path_->Complete();
  }
  fmt::print("{}\n", Summary(outcome));
  std::fflush(stdout);
  if (!loss.empty()) throw std::runtime_error("Samples were lost: " + loss);
  if (interrupted_) {
    fmt::print(stderr, "windhover: {}: interrupted after {} frames\n", source_.name,
               outcome.source_reach.frames);
    return kExitInterrupted;
  }
  const std::string cut_off = CutOff(outcome.source_reach);
  if (!cut_off.empty()) throw std::runtime_error(source_.name + " " + cut_off);
  return kExitOk;
}

}  // namespace

int Run(const RunOptions& options) {
  const Source source = FindSource(options.source);
  StartGStreamer();
  return Job(options, source).Run();
}

}  // namespace windhover
