// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/picture_planes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "gst-plugins/plane_warp.h"
#include "gst-plugins/video_frame_map.h"
#include "service/vision/screen_pose.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

// A grey value that grows with the place in the frame, the same for all of its planes.
double Ramp(const Eigen::Vector2d& x_in_frame) {
  return 20.0 + 1.5 * x_in_frame.x() + 0.7 * x_in_frame.y();
}

Eigen::Vector2d InFrame(int x, int y, int step) {
  return {step * x + 0.5 * (step - 1), step * y + 0.5 * (step - 1)};
}

class PicturePlanesTest : public testing::TestWithParam<GstVideoFormat> {};

// Every plane of every format is put to the same place, whatever its own grid.
TEST_P(PicturePlanesTest, PlanesMoveTogether) {
  const Eigen::Matrix3d pose = CameraMotion(93, 71, 0.2, 0.9, 5.3, -3.8, 2e-4);
  for (const Layout layout : {Layout::kTight, Layout::kWithMeta}) {
    TestVideo video(93, 71, GetParam(), layout);
    const BufferPtr from = video.Black(0);
    const BufferPtr to = video.Black(0);
    const VideoFrameMap from_map(video.info(), from.get(), GST_MAP_READWRITE);
    const VideoFrameMap to_map(video.info(), to.get(), GST_MAP_READWRITE);
    PicturePlanes frame(from_map.frame());
    PicturePlanes screen(to_map.frame());
    ASSERT_EQ(frame.size(), static_cast<std::size_t>(GST_VIDEO_INFO_N_PLANES(&video.info())));
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const int step = frame[i].step;
      const int channels = frame[i].pixels.channels();
      cv::Mat& in = frame[i].pixels;
      for (int y = 0; y < in.rows; ++y) {
        for (int x = 0; x < in.cols * channels; ++x) {
          in.at<std::uint8_t>(y, x) =
              static_cast<std::uint8_t>(std::lround(Ramp(InFrame(x / channels, y, step))));
        }
      }
      cv::Mat& out = screen[i].pixels;
      WarpPlane(in, InPlane(pose, step), Outside::kFill, frame[i].black, out);
      EXPECT_EQ(out.data, PicturePlanes(to_map.frame())[i].pixels.data) << "drawn in place";
      int inside = 0;
      for (int y = 0; y < out.rows; ++y) {
        for (int x = 0; x < out.cols * channels; ++x) {
          const int channel = x % channels;
          const Eigen::Vector2d at = Project(pose.inverse(), InFrame(x / channels, y, step));
          if (at.minCoeff() > 2 && at.x() < 90 && at.y() < 68) {
            EXPECT_NEAR(out.at<std::uint8_t>(y, x), Ramp(at), 1.2) << "plane " << i;
            ++inside;
          } else if (at.minCoeff() < -3.0 || at.x() > 96 || at.y() > 74) {
            EXPECT_EQ(out.at<std::uint8_t>(y, x), frame[i].black[channel]);
          }
        }
      }
      EXPECT_GT(inside, out.rows * out.cols / 2);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, PicturePlanesTest,
                         testing::Values(GST_VIDEO_FORMAT_GRAY8, GST_VIDEO_FORMAT_NV12,
                                         GST_VIDEO_FORMAT_I420, GST_VIDEO_FORMAT_BGR,
                                         GST_VIDEO_FORMAT_BGRx, GST_VIDEO_FORMAT_RGB,
                                         GST_VIDEO_FORMAT_RGBx),
                         [](const auto& info) { return gst_video_format_to_string(info.param); });

// Against OpenCV, at odd sizes, strides and single rows and columns.
TEST(WarpPlane, AgreesWithOpenCv) {
  for (const cv::Size size : {cv::Size(300, 41), {57, 300}, {2, 2}, {9, 1}, {1, 9}, {1, 1}}) {
    for (const int type : {CV_8UC1, CV_8UC2, CV_8UC3, CV_8UC4}) {
      cv::Mat padded(size.height + 3, size.width + 5, type);
      cv::randu(padded, 0, 256);
      cv::blur(padded, padded, {5, 5});  // OpenCV interpolates to 1/32 px
      const cv::Mat source = padded({2, 1, size.width, size.height});
      const Eigen::Matrix3d pose =
          CameraMotion(size.width + 1, size.height + 1, 0.1, 1.1, 0.4, 0.3);
      const Eigen::Matrix3d inverse = pose.inverse();
      cv::Mat m(3, 3, CV_64F);
      for (int i = 0; i < 9; ++i) m.at<double>(i / 3, i % 3) = inverse(i / 3, i % 3);
      cv::Mat expected;
      cv::warpPerspective(source, expected, m, {310, 50}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                          cv::BORDER_REPLICATE);
      cv::Mat drawn(50, 310, type, cv::Scalar(7, 7, 7, 7));
      WarpPlane(source, pose, Outside::kReplicate, {}, drawn);
      EXPECT_LE(cv::norm(drawn, expected, cv::NORM_INF), 6.0) << size << " " << type;
      EXPECT_LT(cv::norm(drawn, expected, cv::NORM_L1) /
                    static_cast<double>(drawn.total() * drawn.channels()),
                0.7);

      // Where nothing is drawn, all stays, or is filled.
      cv::Mat kept(50, 310, type, cv::Scalar(7, 8, 9, 10));
      WarpPlane(source, pose, Outside::kKeep, {}, kept);
      cv::Mat filled(50, 310, type);
      WarpPlane(source, pose, Outside::kFill, {7, 8, 9, 10}, filled);
      EXPECT_EQ(cv::norm(kept, filled, cv::NORM_INF), 0.0);
      WarpPlane(source, CameraMotion(2, 2, 0.0, 1.0, 1000.0, 0.0), Outside::kFill, {7, 8, 9, 10},
                filled);
      EXPECT_EQ(cv::norm(filled, cv::Mat(50, 310, type, cv::Scalar(7, 8, 9, 10)), cv::NORM_INF),
                0.0);
    }
  }
}

TEST(WarpPlane, ThePictureWhereItLiesStaysAsItIs) {
  cv::Mat source(37, 300, CV_8UC3);
  cv::randu(source, 0, 256);
  for (const Outside outside : {Outside::kFill, Outside::kReplicate, Outside::kKeep}) {
    cv::Mat drawn(source.size(), source.type(), cv::Scalar(0, 0, 0));
    WarpPlane(source, CropAsPose(0.3, 300, 37) * CropAsPose(0.3, 300, 37).inverse(), outside, {},
              drawn);
    EXPECT_EQ(cv::norm(drawn, source, cv::NORM_INF), 0.0);
  }
}

TEST(PicturePlanes, BlackFollowsTheRange) {
  for (const bool full : {false, true}) {
    TestVideo video(16, 16, GST_VIDEO_FORMAT_NV12);
    GstVideoInfo info = video.info();
    info.colorimetry.range = full ? GST_VIDEO_COLOR_RANGE_0_255 : GST_VIDEO_COLOR_RANGE_16_235;
    const BufferPtr buffer = video.Black(0);
    const VideoFrameMap map(info, buffer.get(), GST_MAP_READ);
    const PicturePlanes planes(map.frame());
    EXPECT_EQ(planes[0].black[0], full ? 0.0 : 16.0);
    EXPECT_EQ(planes[1].black[0], 128.0);
    EXPECT_EQ(planes[1].black[1], 128.0);
  }
}

TEST(PicturePlanes, OtherFormatsAreRefused) {
  TestVideo video(16, 16, GST_VIDEO_FORMAT_UYVY);
  const BufferPtr buffer(
      gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&video.info()), nullptr));
  const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READ);
  EXPECT_THROW(PicturePlanes planes(map.frame()), std::invalid_argument);
}

}  // namespace
}  // namespace windhover
