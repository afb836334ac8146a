// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace windhover {

// 16-bit grey values that are shown as 0 and 255; those between go linearly. low < high.
struct GrayRange {
  double low = 0.0;
  double high = 65535.0;
};

// How often each 16-bit grey value occurs in a picture.
class GrayHistogram {
 public:
  void Clear();
  void Add(std::uint16_t value) {
    ++counts_[value];
    ++pixels_;
  }

  // The picture's values without its darkest and brightest 0.1 % (one pixel at least, so that a
  // single hot or dead pixel never counts), widened about their middle to 32 where they lie closer:
  // a sensor's noise is no contrast. An empty picture has the range 0 to 65535.
  GrayRange RobustRange() const;

 private:
  std::vector<std::uint32_t> counts_ = std::vector<std::uint32_t>(65536);
  std::uint64_t pixels_ = 0;
};

// 8-bit grey value of each 16-bit one, rounded to the nearest.
using GrayTable = std::array<std::uint8_t, 65536>;
void FillTable(const GrayRange& range, GrayTable& table);

// The range in which the 16-bit frames of a stream are shown. Registration and the median
// background compare grey levels of frames, so it stands still as long as it fits: it is set with
// room on both sides. Where the picture drifts out of it, it follows by a quarter of a grey level a
// frame, which is far below the threshold of a motion seed over a whole window. Where it no longer
// fits at all, it jumps. Frames that are the same make the same ranges.
class StreamGrayRange {
 public:
  // Takes the robust range of the next frame. True where the range jumped: grey levels before and
  // from this frame on cannot be compared. The first frame after construction or Reset is no jump.
  bool Follow(const GrayRange& frame);
  const GrayRange& range() const { return range_; }
  void Reset() { started_ = false; }

 private:
  GrayRange range_;
  bool started_ = false;
};

}  // namespace windhover
