// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "service/dds/dds_error.h"  // IWYU pragma: export
#include "service/options/publish_options.h"
#include "service/vision/types.h"

namespace windhover {

// Writes the homographies and detections of one stream to the bus. A frame makes one sample of each
// topic, also where it has no detections.
//
// threads  Publish and End by one thread at a time; counters() and subscribers() by any.
// waiting  A write waits up to PublishOptions::max_blocking_ms for room where reliable subscribers
//          lag behind, and not at all otherwise: a stalled subscriber slows a video down to two
//          such waits a frame until its lease ends (10 s after its process stopped answering).
// memory   Samples are written from buffers made once; nothing is allocated per sample here.
class Publisher {
 public:
  // Samples since construction.
  struct Counters {
    std::uint64_t homographies = 0;  // written
    std::uint64_t detections = 0;    // samples written, not boxes
    std::uint64_t boxes = 0;         // detections inside those samples
    std::uint64_t failed = 0;        // samples of either topic that could not be written
    std::uint64_t omitted = 0;       // detections over kMaxDetections, left out of their samples
  };

  // Detections that one sample holds. Of more, the first are sent; the sample says how many are
  // not.
  static constexpr int kMaxDetections = 1024;

  // Called with the value of subscribers() whenever it may have changed.
  using SubscribersChanged = std::function<void(int subscribers)>;

  // Subscribers can find the stream from now on. `subscribers_changed`, where given, is called by a
  // thread of the DDS library, perhaps before this constructor returns and not any more once the
  // destructor has; it must return soon, must not throw and must not call into this publisher.
  // Throws OptionError for options out of range, DdsError where the bus cannot be used.
  explicit Publisher(const PublishOptions& options, SubscribersChanged subscribers_changed = {});
  // As End(), and without waiting where End() has been called.
  ~Publisher();

  // `width` and `height` are of the frame, in px; `pts_ns` is its presentation time, negative where
  // it has none. False where the sample could not be written (see `waiting`); that is counted.
  bool Publish(const FrameRegistration& registration, int width, int height, std::int64_t pts_ns);
  bool Publish(std::uint64_t frame_number, int width, int height, std::int64_t pts_ns,
               const std::vector<Detection>& detections);

  // The stream is over: disposes its instances, so that subscribers see the end after the last
  // sample, and waits until reliable subscribers have acknowledged everything. False where the end
  // could not be written or they have not. Each step waits up to max_blocking_ms for reliable
  // subscribers that lag behind; the first that waits in vain is the last. Called again it does
  // nothing and returns the same. Publishing again starts the stream anew.
  bool End();

  Counters counters() const;
  // Subscribers matched: the smaller of the two topics' numbers.
  int subscribers() const;
  // Those of them that name this partition among theirs; empty is the default partition.
  int subscribers(const std::string& partition) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace windhover
