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

}  // namespace

void ExtractLuma(const GstVideoFrame& frame, GrayImage& gray) {
  const int width = GST_VIDEO_FRAME_WIDTH(&frame);
  const int height = GST_VIDEO_FRAME_HEIGHT(&frame);
  if (gray.width() != width || gray.height() != height) {
    throw std::invalid_argument("the luma image does not have the frame's size");
  }
  const RowFunction convert_row = RowFunctionFor(GST_VIDEO_FRAME_FORMAT(&frame));
  const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
  const std::ptrdiff_t stride = GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
  const MappedImage<std::uint8_t> mapped = gray.Write();
  for (int y = 0; y < height; ++y) convert_row(data + y * stride, mapped.row(y), width);
}

}  // namespace windhover
