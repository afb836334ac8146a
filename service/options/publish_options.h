// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/options/option.h"

namespace windhover {

// How homographies and detections go on the bus. The table of topics and QoS is in idl/README.md.
struct PublishOptions {
  std::string stream = "default";
  int domain = 0;
  std::string partition;
  bool reliable = true;
  int history_depth = 256;
  int max_blocking_ms = 100;
  int detections_lifespan_ms = 0;

  static constexpr auto Fields() {
    using O = PublishOptions;
    return std::make_tuple(
        Text("stream", &O::stream,
             "Name of the stream on the bus, 1 to 64 bytes: the key of all its samples"),
        Number("domain", &O::domain, 0, 230, "", "DDS domain"),
        Text("partition", &O::partition,
             "DDS partitions, separated by commas; an empty name is the default partition"),
        Flag("reliable", &O::reliable,
             "Repeat what a subscriber has missed; otherwise best effort, which never waits"),
        Number("history-depth", &O::history_depth, 0, 100000, "samples",
               "Samples of each topic kept for subscribers that lag behind; 0 keeps all that a "
               "reliable subscriber has not acknowledged"),
        Number("max-blocking", &O::max_blocking_ms, 0, 60000, "ms",
               "Longest wait of one write for room, where subscribers lag behind; the sample is "
               "dropped and counted after it"),
        Number("detections-lifespan", &O::detections_lifespan_ms, 0, 3600000, "ms",
               "Age at which detections are no longer delivered; 0 delivers all"));
  }
};

}  // namespace windhover
