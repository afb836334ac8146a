// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "service/dds/dds_error.h"  // IWYU pragma: export
#include "service/dds/samples.h"

namespace windhover {

enum class Topic { kHomography, kDetections };

struct SubscribeOptions {
  int domain = 0;         // 0 to 230
  std::string partition;  // DDS partitions as in PublishOptions
  std::string stream;     // only samples of this stream; empty takes all streams
  bool homographies = true;
  bool detections = true;
  // Ask for what has been missed. A reliable subscriber does not match a best-effort publisher.
  bool reliable = true;
  // Samples kept of each stream and topic until Poll takes them; 0 keeps all.
  int history_depth = 0;
};

// Reads homographies and detections from the bus.
//
// threads  Poll by one thread at a time, which also calls the handlers; Interrupt by any.
// order    Samples of one topic and stream come as they were written. There is no order between the
//          two topics.
// memory   Samples are handed over in objects that are used again; nothing is allocated per sample
//          here once they have grown to the largest.
class Subscriber {
 public:
  enum class EndReason {
    kEnded,  // the publisher ended the stream, or closed
    kLost,   // the publisher is gone without a word
  };

  // Handlers may be empty. The samples are valid during the call only. Exceptions pass through
  // Poll; samples taken with the one that threw are lost.
  struct Handlers {
    std::function<void(const HomographySample&)> homography;
    std::function<void(const DetectionsSample&)> detections;
    // After the last sample of the stream on that topic.
    std::function<void(const std::string& stream, Topic topic, EndReason reason)> end;
    // The number of publishers that each of the topics asked for has (the smaller of the two).
    std::function<void(int publishers)> publishers_changed;
  };

  // Throws DdsError where the bus cannot be used.
  explicit Subscriber(const SubscribeOptions& options);
  ~Subscriber();

  // Waits up to `longest` (forever where it is negative) until something happens, and hands over
  // what is there, but at most 16 samples of each topic: the rest comes with the next calls. False
  // when it waited in vain or was interrupted.
  bool Poll(std::chrono::nanoseconds longest, const Handlers& handlers);

  // Ends the wait of the present call of Poll, or that of the next.
  void Interrupt();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace windhover
