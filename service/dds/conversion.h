// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>
#include <vector>

#include "service/dds/samples.h"

namespace windhover {

// Between our values and the types that are generated from idl/. Only conversion.cc names those.

const dds_topic_descriptor_t* HomographyDescriptor();
const dds_topic_descriptor_t* DetectionsDescriptor();

// A sample to write, in the layout of the topic's type; made once for a stream. `stream` has at
// most kMaxStreamName bytes.
inline constexpr std::size_t kMaxStreamName = 64;

class HomographyMessage {
 public:
  explicit HomographyMessage(const std::string& stream);
  ~HomographyMessage();
  void Set(const FrameRegistration& registration, int width, int height, std::int64_t pts_ns);
  const void* data() const;

 private:
  struct Layout;
  std::unique_ptr<Layout> layout_;
};

class DetectionsMessage {
 public:
  static constexpr std::size_t kCapacity = 1024;

  explicit DetectionsMessage(const std::string& stream);
  ~DetectionsMessage();
  // Returns how many detections found no room.
  std::size_t Set(std::uint64_t frame_number, int width, int height, std::int64_t pts_ns,
                  const std::vector<Detection>& detections);
  const void* data() const;

 private:
  struct Layout;
  std::unique_ptr<Layout> layout_;
};

// The key of a received sample of either topic; valid as long as the sample.
const char* HomographyStream(const void* message);
const char* DetectionsStream(const void* message);

// All but written_ns. Reuses the memory of `sample`.
void Read(const void* message, HomographySample& sample);
void Read(const void* message, DetectionsSample& sample);

}  // namespace windhover
