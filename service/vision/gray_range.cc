// SPDX-License-Identifier: Apache-2.0
#include "service/vision/gray_range.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr double kSmallestWidth = 32.0;
constexpr std::uint64_t kOneOutOf = 1000;  // is left out at each end

// In shares of the range's width.
constexpr double kRoom = 1.0 / 8.0;  // on each side of a frame's own range when it is set
constexpr double kStep = 0.25 / 255.0;
constexpr double kFarOutside = 1.0 / 4.0;  // of it on one side: most detail there would be clipped
// A frame that fills less than this share of the range has lost most of its grey levels.
constexpr double kFilledTooLittle = 1.0 / 4.0;

GrayRange WithRoom(const GrayRange& frame) {
  const double room = kRoom * (frame.high - frame.low);
  return {frame.low - room, frame.high + room};
}

}  // namespace

void GrayHistogram::Clear() {
  std::fill(counts_.begin(), counts_.end(), 0U);
  pixels_ = 0;
}

GrayRange GrayHistogram::RobustRange() const {
  if (pixels_ == 0) return {};
  // Of one or two pixels none can be left out.
  const std::uint64_t left_out =
      std::min(std::max<std::uint64_t>(1, pixels_ / kOneOutOf), (pixels_ - 1) / 2);
  int low = 0, high = 65535;
  for (std::uint64_t below = counts_[low]; below <= left_out; below += counts_[low]) ++low;
  for (std::uint64_t above = counts_[high]; above <= left_out; above += counts_[high]) --high;
  const double middle = 0.5 * (low + high);
  const double half = 0.5 * std::max<double>(kSmallestWidth, high - low);
  return {middle - half, middle + half};
}

void FillTable(const GrayRange& range, GrayTable& table) {
  const double scale = 255.0 / (range.high - range.low);
  for (std::size_t value = 0; value < table.size(); ++value) {
    const double level = (static_cast<double>(value) - range.low) * scale;
    table[value] = static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.0, 255.0)));
  }
}

bool StreamGrayRange::Follow(const GrayRange& frame) {
  if (!started_) {
    started_ = true;
    range_ = WithRoom(frame);
    return false;
  }
  const double width = range_.high - range_.low;
  const double outside = std::max(range_.low - frame.low, frame.high - range_.high);
  if (outside > kFarOutside * width || frame.high - frame.low < kFilledTooLittle * width) {
    range_ = WithRoom(frame);
    return true;
  }
  const double step = kStep * width;
  range_.low -= std::clamp(range_.low - frame.low, 0.0, step);
  range_.high += std::clamp(frame.high - range_.high, 0.0, step);
  return false;
}

}  // namespace windhover
