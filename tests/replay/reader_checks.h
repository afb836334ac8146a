// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "replay/format/frame_source.h"
#include "replay/readers/recording.h"
#include "tests/replay/complaint.h"

// Of a recording of any set. The tests write each set in its own layout, by hand.

namespace windhover::replay {

inline std::string OpenComplaint(const std::filesystem::path& path) {
  return Complaint([&] { OpenRecording(path); });
}

inline void ExpectBox(const Label& label, int frame, std::int64_t id, const Box& box,
                      double score) {
  EXPECT_EQ(label.box.frame, frame);
  EXPECT_EQ(label.box.id, id);
  EXPECT_EQ(label.box.box.x, box.x);
  EXPECT_EQ(label.box.box.y, box.y);
  EXPECT_EQ(label.box.box.width, box.width);
  EXPECT_EQ(label.box.box.height, box.height);
  EXPECT_EQ(label.box.score, score);
}

inline int CountFrames(const Recording& recording) {
  const std::unique_ptr<FrameSource> source = recording.open_frames();
  int frames = 0;
  while (!source->Next().empty()) ++frames;
  return frames;
}

}  // namespace windhover::replay
