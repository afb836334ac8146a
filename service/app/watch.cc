// SPDX-License-Identifier: Apache-2.0
#include "service/app/watch.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "service/app/exit_code.h"
#include "service/app/sample_text.h"
#include "service/app/signal_thread.h"
#include "service/dds/log.h"

namespace windhover {
namespace {

constexpr std::chrono::nanoseconds kForever(-1);
// For samples that are still on their way through the DDS library when their publisher has gone.
constexpr std::chrono::nanoseconds kGrace = std::chrono::seconds(1);

// Nobody reads the output any more.
struct OutputClosed {};

void WriteAll(const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t result = write(STDOUT_FILENO, text.data() + written, text.size() - written);
    if (result >= 0) {
      written += static_cast<std::size_t>(result);
    } else if (errno == EPIPE) {
      throw OutputClosed();
    } else if (errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "Cannot write to the output");
    }
  }
}

// Prints, and knows when it has been enough.
class Printer {
 public:
  explicit Printer(const WatchOptions& options) : options_(options) {}

  Subscriber::Handlers handlers() {
    Subscriber::Handlers handlers;
    handlers.homography = [this](const HomographySample& sample) {
      Print(Topic::kHomography, sample);
    };
    handlers.detections = [this](const DetectionsSample& sample) {
      Print(Topic::kDetections, sample);
    };
    handlers.end = [this](const std::string& stream, Topic topic, Subscriber::EndReason reason) {
      End(stream, topic, reason);
    };
    handlers.publishers_changed = [this](int publishers) {
      if (done()) return;
      publishers_ = publishers;
      WriteAll(options_.json ? JsonPublishersLine(publishers) : TextPublishersLine(publishers));
    };
    return handlers;
  }

  bool done() const {
    if (options_.count > 0 && samples_ == options_.count) return true;
    return options_.until_end && open_.empty() &&
           (homographies_ended_ || !options_.subscribe.homographies) &&
           (detections_ended_ || !options_.subscribe.detections);
  }

  // A stream has ended on one topic, but nothing is known of the other, and nobody is there who
  // could tell: its publisher has died before it could.
  bool other_topic_missing() const {
    return options_.until_end && !done() && open_.empty() && publishers_ == 0 &&
           (homographies_ended_ || detections_ended_);
  }

  bool lost() const { return lost_; }

 private:
  template <typename Sample>
  void Print(Topic topic, const Sample& sample) {
    if (done()) return;
    ++samples_;
    if (options_.until_end) open_.emplace(topic, sample.stream);
    WriteAll(options_.json ? JsonLine(sample) : TextLine(sample));
  }

  void End(const std::string& stream, Topic topic, Subscriber::EndReason reason) {
    if (done()) return;
    open_.erase({topic, stream});
    (topic == Topic::kHomography ? homographies_ended_ : detections_ended_) = true;
    lost_ = lost_ || reason == Subscriber::EndReason::kLost;
    WriteAll(options_.json ? JsonEndLine(stream, topic, reason)
                           : TextEndLine(stream, topic, reason));
  }

  const WatchOptions& options_;
  int publishers_ = 0;
  std::uint64_t samples_ = 0;
  std::set<std::pair<Topic, std::string>> open_;
  bool homographies_ended_ = false;
  bool detections_ended_ = false;
  bool lost_ = false;
};

}  // namespace

int Watch(const WatchOptions& options) {
  BlockEndSignals();
  Subscriber subscriber(options.subscribe);
  std::atomic<bool> interrupted = false;
  const SignalThread signals([&] {
    interrupted = true;
    subscriber.Interrupt();
  });
  Printer printer(options);
  const Subscriber::Handlers handlers = printer.handlers();
  bool lost = false;
  try {
    while (!interrupted && !lost && !printer.done()) {
      const bool missing = printer.other_topic_missing();
      const bool something = subscriber.Poll(missing ? kGrace : kForever, handlers);
      lost = missing && !something && !interrupted;
    }
  } catch (const OutputClosed&) {
    return kExitOk;
  }
  if (lost || printer.lost()) {
    Log()->error("A publisher is gone without having ended its stream");
    return kExitFailed;
  }
  const bool early = !printer.done() && (options.until_end || options.count > 0);
  return early ? kExitInterrupted : kExitOk;
}

}  // namespace windhover
