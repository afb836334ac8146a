// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/luma.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gst-plugins/video_frame_map.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

struct LumaCase {
  GstVideoFormat format;
  Layout layout;
};

void PrintTo(const LumaCase& c, std::ostream* out) { *out << gst_video_format_to_string(c.format); }

class LumaTest : public testing::TestWithParam<LumaCase> {};

// Widths and heights that no vector length divides; every byte of the picture counts.
TEST_P(LumaTest, EqualsTheWrittenOutSum) {
  const auto backend = Backend::Create("cpu");
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {33, 17}, {161, 121}}) {
    TestVideo video(width, height, GetParam().format, GetParam().layout);
    const BufferPtr buffer = video.Frame(3);
    {
      // Colours that tell the channels apart.
      const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_WRITE);
      for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&map.frame()); ++c) {
        auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&map.frame(), c));
        for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&map.frame(), c); ++y) {
          for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&map.frame(), c); ++x) {
            data[y * GST_VIDEO_FRAME_COMP_STRIDE(&map.frame(), c) +
                 x * GST_VIDEO_FRAME_COMP_PSTRIDE(&map.frame(), c)] =
                static_cast<std::uint8_t>((x * 37 + y * 101 + c * 83) % 256);
          }
        }
      }
    }
    GrayImage gray = backend->MakeImage<std::uint8_t>(width, height);
    const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READ);
    ExtractLuma(map.frame(), gray);
    const auto read = gray.Read();
    const bool rgb = GST_VIDEO_INFO_IS_RGB(&video.info());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto component = [&](int c) { return (x * 37 + y * 101 + c * 83) % 256; };
        const double expected =
            rgb ? 0.299 * component(0) + 0.587 * component(1) + 0.114 * component(2) : component(0);
        ASSERT_LE(std::abs(read.at(x, y) - expected), rgb ? 0.502 : 0.0) << x << "," << y;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, LumaTest,
                         testing::Values(LumaCase{GST_VIDEO_FORMAT_GRAY8, Layout::kTight},
                                         LumaCase{GST_VIDEO_FORMAT_GRAY8, Layout::kWithMeta},
                                         LumaCase{GST_VIDEO_FORMAT_NV12, Layout::kWithMeta},
                                         LumaCase{GST_VIDEO_FORMAT_I420, Layout::kWithMeta},
                                         LumaCase{GST_VIDEO_FORMAT_BGR, Layout::kTight},
                                         LumaCase{GST_VIDEO_FORMAT_BGR, Layout::kWithMeta},
                                         LumaCase{GST_VIDEO_FORMAT_BGRx, Layout::kWithMeta},
                                         LumaCase{GST_VIDEO_FORMAT_RGB, Layout::kWithMeta},
                                         LumaCase{GST_VIDEO_FORMAT_RGBx, Layout::kTight}),
                         [](const auto& info) {
                           return std::string(gst_video_format_to_string(info.param.format)) +
                                  (info.param.layout == Layout::kTight ? "Tight" : "Padded");
                         });

TEST(Luma, WhiteIsWhiteAndBlackIsBlack) {
  const auto backend = Backend::Create("cpu");
  TestVideo video(40, 30, GST_VIDEO_FORMAT_BGR);
  const BufferPtr buffer = video.Black(0);
  GrayImage gray = backend->MakeImage<std::uint8_t>(40, 30);
  for (const int value : {0, 255}) {
    gst_buffer_memset(buffer.get(), 0, value, gst_buffer_get_size(buffer.get()));
    const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READ);
    ExtractLuma(map.frame(), gray);
    EXPECT_EQ(gray.Read().at(39, 29), value);
  }
}

TEST(Luma, RefusesWhatDoesNotFit) {
  const auto backend = Backend::Create("cpu");
  TestVideo video(40, 30, GST_VIDEO_FORMAT_YUY2);
  const BufferPtr buffer(
      gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&video.info()), nullptr));
  const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READ);
  GrayImage gray = backend->MakeImage<std::uint8_t>(40, 30);
  EXPECT_THROW(ExtractLuma(map.frame(), gray), std::invalid_argument);
  GrayImage other = backend->MakeImage<std::uint8_t>(40, 31);
  EXPECT_THROW(ExtractLuma(map.frame(), other), std::invalid_argument);
}

TEST(VideoFrameMap, RefusesBuffersThatAreTooSmallOrOfAnotherSize) {
  TestVideo video(40, 30);
  const BufferPtr small(gst_buffer_new_allocate(nullptr, 1199, nullptr));
  EXPECT_THROW(VideoFrameMap(video.info(), small.get(), GST_MAP_READ), std::runtime_error);
  TestVideo larger(41, 30, GST_VIDEO_FORMAT_GRAY8, Layout::kWithMeta);
  const BufferPtr other = larger.Frame(0);
  EXPECT_THROW(VideoFrameMap(video.info(), other.get(), GST_MAP_READ), std::runtime_error);
}

}  // namespace
}  // namespace windhover
