// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/luma.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

void CopyRow(const std::uint8_t* from, std::uint8_t* to, int width) {
  std::memcpy(to, from, width);
}

// Weights in 1/65536; they add up to 65536.
constexpr std::uint32_t kRed = 19595;
constexpr std::uint32_t kGreen = 38470;
constexpr std::uint32_t kBlue = 7471;

template <int kRedAt, int kBlueAt, int kBytes>
inline void WeightRow(const std::uint8_t* from, std::uint8_t* to, int width) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* pixel = from + x * kBytes;
    const std::uint32_t sum =
        kRed * pixel[kRedAt] + kGreen * pixel[1] + kBlue * pixel[kBlueAt] + 32768;
    to[x] = static_cast<std::uint8_t>(sum >> 16);
  }
}

WINDHOVER_MULTIVERSION void WeightRowBgr(const std::uint8_t* from, std::uint8_t* to, int width) {
  WeightRow<2, 0, 3>(from, to, width);
}
WINDHOVER_MULTIVERSION void WeightRowBgrx(const std::uint8_t* from, std::uint8_t* to, int width) {
  WeightRow<2, 0, 4>(from, to, width);
}
WINDHOVER_MULTIVERSION void WeightRowRgb(const std::uint8_t* from, std::uint8_t* to, int width) {
  WeightRow<0, 2, 3>(from, to, width);
}
WINDHOVER_MULTIVERSION void WeightRowRgbx(const std::uint8_t* from, std::uint8_t* to, int width) {
  WeightRow<0, 2, 4>(from, to, width);
}

using RowFunction = void (*)(const std::uint8_t* from, std::uint8_t* to, int width);

RowFunction RowFunctionFor(GstVideoFormat format) {
  switch (format) {
    case GST_VIDEO_FORMAT_GRAY8:
    case GST_VIDEO_FORMAT_NV12:
    case GST_VIDEO_FORMAT_I420:
      return CopyRow;
    case GST_VIDEO_FORMAT_BGR:
      return WeightRowBgr;
    case GST_VIDEO_FORMAT_BGRx:
      return WeightRowBgrx;
    case GST_VIDEO_FORMAT_RGB:
      return WeightRowRgb;
    case GST_VIDEO_FORMAT_RGBx:
      return WeightRowRgbx;
    default:
      throw std::invalid_argument(std::string("no luma from the video format ") +
                                  gst_video_format_to_string(format));
  }
}

void CheckSize(const GstVideoFrame& frame, const GrayImage& gray) {
  if (gray.width() != GST_VIDEO_FRAME_WIDTH(&frame) ||
      gray.height() != GST_VIDEO_FRAME_HEIGHT(&frame)) {
    throw std::invalid_argument("the luma image does not have the frame's size");
  }
}

// Calls visit(x, y, value) for each pixel of a GRAY16 frame; bytes may lie at odd addresses.
template <typename Visit>
void ForEachGray16(const GstVideoFrame& frame, Visit visit) {
  const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
  const std::ptrdiff_t stride = GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
  const int low_byte = GST_VIDEO_FRAME_FORMAT(&frame) == GST_VIDEO_FORMAT_GRAY16_LE ? 0 : 1;
  for (int y = 0; y < GST_VIDEO_FRAME_HEIGHT(&frame); ++y) {
    const std::uint8_t* row = data + y * stride;
    for (int x = 0; x < GST_VIDEO_FRAME_WIDTH(&frame); ++x) {
      visit(x, y,
            static_cast<std::uint16_t>(row[2 * x + low_byte] | row[2 * x + 1 - low_byte] << 8));
    }
  }
}

}  // namespace

void ExtractLuma(const GstVideoFrame& frame, GrayImage& gray) {
  CheckSize(frame, gray);
  const RowFunction convert_row = RowFunctionFor(GST_VIDEO_FRAME_FORMAT(&frame));
  const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
  const std::ptrdiff_t stride = GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
  const MappedImage<std::uint8_t> mapped = gray.Write();
  for (int y = 0; y < gray.height(); ++y) {
    convert_row(data + y * stride, mapped.row(y), gray.width());
  }
}

bool StreamLuma::Extract(const GstVideoFrame& frame, GrayImage& gray) {
  const GstVideoFormat format = GST_VIDEO_FRAME_FORMAT(&frame);
  if (format != GST_VIDEO_FORMAT_GRAY16_LE && format != GST_VIDEO_FORMAT_GRAY16_BE) {
    ExtractLuma(frame, gray);
    return false;
  }
  CheckSize(frame, gray);
  if (automatic_ == nullptr) automatic_ = std::make_unique<Automatic>();
  Automatic& automatic = *automatic_;
  automatic.histogram.Clear();
  ForEachGray16(frame, [&](int, int, std::uint16_t value) { automatic.histogram.Add(value); });
  const bool jumped = automatic.range.Follow(automatic.histogram.RobustRange());
  FillTable(automatic.range.range(), automatic.table);
  const MappedImage<std::uint8_t> mapped = gray.Write();
  ForEachGray16(
      frame, [&](int x, int y, std::uint16_t value) { mapped.at(x, y) = automatic.table[value]; });
  return jumped;
}

void StreamLuma::Reset() {
  if (automatic_ != nullptr) automatic_->range.Reset();
}

}  // namespace windhover
