// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/overlay_drawing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "gst-plugins/video_frame_map.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

// Red, green and blue of a pixel, whatever the format.
std::array<double, 3> RgbAt(const GstVideoFrame& frame, int x, int y) {
  const auto component = [&](int c) -> double {
    const int step_x = GST_VIDEO_FORMAT_INFO_W_SUB(frame.info.finfo, c);
    const int step_y = GST_VIDEO_FORMAT_INFO_H_SUB(frame.info.finfo, c);
    const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, c));
    return data[(y >> step_y) * GST_VIDEO_FRAME_COMP_STRIDE(&frame, c) +
                (x >> step_x) * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, c)];
  };
  if (GST_VIDEO_INFO_IS_RGB(&frame.info)) return {component(0), component(1), component(2)};
  const double luma = 1.164 * (component(0) - 16.0);
  if (GST_VIDEO_INFO_IS_GRAY(&frame.info)) return {luma, luma, luma};
  const double u = component(1) - 128.0;
  const double v = component(2) - 128.0;
  return {luma + 1.596 * v, luma - 0.392 * u - 0.813 * v, luma + 2.017 * u};
}

class CanvasTest : public testing::TestWithParam<GstVideoFormat> {};

TEST_P(CanvasTest, ColoursLandWhereTheyShould) {
  for (const auto& [width, height] : {std::pair{64, 48}, {65, 47}}) {
    TestVideo video(width, height, GetParam(), Layout::kWithMeta);
    const BufferPtr buffer = video.Black(0);
    const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READWRITE);
    Canvas canvas(map.frame());
    EXPECT_EQ(canvas.width(), width);
    EXPECT_EQ(canvas.height(), height);
    canvas.FillRectangle({8, 10, 20, 16}, {220, 40, 90});
    const auto inside = RgbAt(map.frame(), 16, 18);
    if (GetParam() == GST_VIDEO_FORMAT_GRAY8) {
      EXPECT_NEAR(inside[0], 0.299 * 220 + 0.587 * 40 + 0.114 * 90, 3.0);
    } else {
      EXPECT_NEAR(inside[0], 220, 4.0);
      EXPECT_NEAR(inside[1], 40, 4.0);
      EXPECT_NEAR(inside[2], 90, 4.0);
    }
    const auto outside = RgbAt(map.frame(), 40, 30);
    EXPECT_LT(outside[0], 1.0);
  }
}

// Everything is drawn over and outside all borders; sanitizers watch the memory around it.
TEST_P(CanvasTest, DrawsOverTheBorders) {
  TestVideo video(65, 47, GetParam());
  const BufferPtr buffer = video.Frame(0);
  const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READWRITE);
  Canvas canvas(map.frame());
  const Colour colour = {255, 255, 255};
  canvas.DrawLine({-100, -50}, {200, 90}, colour, 3);
  canvas.DrawLine({-1e9, 20}, {1e9, 20}, colour, 1);
  canvas.DrawLine({NAN, 0}, {1, 1}, colour, 1);
  canvas.DrawRectangle({-5, -5}, {80, 60}, colour, 2);
  canvas.DrawText({-10, 5}, "over the left border", 9, colour);
  canvas.DrawText({60, 46}, "over the right border", 9, colour);
  canvas.FillCircle({64, 46}, 8, colour);
  canvas.FillRectangle({-10, -10, 500, 12}, colour);
  canvas.Darken({0, 40, 100, 100});
  EXPECT_GT(RgbAt(map.frame(), 30, 0)[0], 240.0);
}

TEST_P(CanvasTest, DarkensTowardsBlack) {
  TestVideo video(64, 48, GetParam());
  const BufferPtr buffer = video.Black(0);
  const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READWRITE);
  Canvas canvas(map.frame());
  canvas.FillRectangle({0, 0, 64, 48}, {200, 100, 50});
  const auto before = RgbAt(map.frame(), 10, 40);
  canvas.Darken({0, 30, 64, 18});
  const auto after = RgbAt(map.frame(), 10, 40);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c], 0.35 * before[c], 5.0);
  EXPECT_EQ(RgbAt(map.frame(), 10, 20), before);
  if (GST_VIDEO_FRAME_COMP_PSTRIDE(&map.frame(), 0) == 4) {
    const auto* pixel =
        static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&map.frame(), 0)) +
        40 * GST_VIDEO_FRAME_PLANE_STRIDE(&map.frame(), 0);
    EXPECT_EQ(pixel[3], 255) << "what FillRectangle wrote";
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, CanvasTest,
                         testing::Values(GST_VIDEO_FORMAT_GRAY8, GST_VIDEO_FORMAT_NV12,
                                         GST_VIDEO_FORMAT_I420, GST_VIDEO_FORMAT_BGR,
                                         GST_VIDEO_FORMAT_BGRx, GST_VIDEO_FORMAT_RGB,
                                         GST_VIDEO_FORMAT_RGBx),
                         [](const auto& info) {
                           return std::string(gst_video_format_to_string(info.param));
                         });

class OverlayDrawingTest : public testing::Test {
 protected:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;

  // Pixels that drawing changed.
  int Changed(const OverlayOptions& options, const FrameRegistration* registration,
              const std::vector<Detection>& detections, int frames = 1) {
    OverlayDrawing drawing(options);
    int changed = 0;
    for (int t = 0; t < frames; ++t) {
      const BufferPtr buffer = video_.Black(t);
      const VideoFrameMap map(video_.info(), buffer.get(), GST_MAP_READWRITE);
      Canvas canvas(map.frame());
      drawing.Draw(registration, detections, canvas);
      changed = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) changed += RgbAt(map.frame(), x, y)[0] > 20.0;
      }
      last_corner_ = RgbAt(map.frame(), 0, 0);
    }
    return changed;
  }

  static OverlayOptions Nothing() { return {false, false, false, 60, false}; }

  TestVideo video_{kWidth, kHeight, GST_VIDEO_FORMAT_RGB};
  FrameRegistration registration_;
  std::vector<Detection> detections_ = {{1, {50.0, 40.0, 20.0, 10.0}, {2.0, 0.0}, 0.9, 5}};
  std::array<double, 3> last_corner_{};
};

TEST_F(OverlayDrawingTest, EachOptionDrawsOfItself) {
  EXPECT_EQ(Changed(Nothing(), &registration_, detections_), 0);
  for (bool OverlayOptions::*part :
       {&OverlayOptions::boxes, &OverlayOptions::ids, &OverlayOptions::status}) {
    OverlayOptions options = Nothing();
    options.*part = true;
    EXPECT_GT(Changed(options, &registration_, detections_), 10);
  }
  OverlayOptions options = Nothing();
  options.trails = true;
  EXPECT_EQ(Changed(options, &registration_, detections_, 1), 0) << "one point is no way";
  registration_.previous_from_frame(0, 2) = 3.0;
  EXPECT_GT(Changed(options, &registration_, detections_, 10), 10);
}

TEST_F(OverlayDrawingTest, LostFramesAreMarked) {
  EXPECT_EQ(Changed(Nothing(), &registration_, {}), 0);
  registration_.quality = RegistrationQuality::kLost;
  EXPECT_GT(Changed(Nothing(), &registration_, {}), 2 * kWidth);
  EXPECT_GT(last_corner_[0], 200.0);
  EXPECT_LT(last_corner_[1], 100.0);
}

TEST_F(OverlayDrawingTest, BoxesWithoutRegistration) {
  EXPECT_GT(Changed(OverlayOptions{}, nullptr, detections_), 10);
}

}  // namespace
}  // namespace windhover
