// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/mosaic.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "gst-plugins/video_frame_map.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

constexpr int kWidth = 161;
constexpr int kHeight = 121;

Eigen::Matrix3d Shift(double x, double y) { return CameraMotion(kWidth, kHeight, 0, 1, x, y); }

// Frames of a SyntheticGround, put on a screen one after the other.
class MosaicTest : public testing::Test {
 protected:
  // `screen_from_ground` says where the ground is held.
  void Show(const Eigen::Matrix3d& ground_from_frame, const Eigen::Matrix3d& screen_from_ground) {
    // Without noise, and with lines around the frame as bad cameras make them.
    ground_.Render(ground_from_frame, 0.0, 1, gray_, [](int x, int y, double value) {
      return x == 0 || y == 0 || x == kWidth - 1 || y == kHeight - 1 ? 255.0 : value;
    });
    const BufferPtr in = video_.Black(0);
    const VideoFrameMap from(video_.info(), in.get(), GST_MAP_READWRITE);
    const VideoFrameMap to(video_.info(), out_.get(), GST_MAP_READWRITE);
    PicturePlanes frame(from.frame());
    PicturePlanes screen(to.frame());
    const auto view = gray_.Read();
    for (int y = 0; y < kHeight; ++y) std::copy_n(view.row(y), kWidth, frame[0].pixels.ptr(y));
    ScreenPose pose;
    pose.screen_from_frame = screen_from_ground * ground_from_frame;
    pose.previous_screen_from_screen = screen_from_ground_ * screen_from_ground.inverse();
    screen_from_ground_ = screen_from_ground;
    mosaic_.Show(frame, pose, screen);
  }

  // Mean difference to the ground as it should lie on the screen, over columns [from, to).
  double Difference(int from, int to) {
    const VideoFrameMap map(video_.info(), out_.get(), GST_MAP_READ);
    const PicturePlanes screen(map.frame());
    double sum = 0.0;
    for (int y = 5; y < kHeight - 5; ++y) {
      for (int x = from; x < to; ++x) {
        const Eigen::Vector2d at = Project(screen_from_ground_.inverse(), {x, y});
        sum += std::abs(screen[0].pixels.at<std::uint8_t>(y, x) - ground_.At(at.x(), at.y()));
      }
    }
    return sum / ((kHeight - 10) * (to - from));
  }

  int Pixel(int x, int y) {
    const VideoFrameMap map(video_.info(), out_.get(), GST_MAP_READ);
    return PicturePlanes(map.frame())[0].pixels.at<std::uint8_t>(y, x);
  }

  TestVideo video_{kWidth, kHeight, GST_VIDEO_FORMAT_I420};
  SyntheticGround ground_;
  std::shared_ptr<Backend> backend_ = Backend::Create("cpu");
  GrayImage gray_ = backend_->MakeImage<std::uint8_t>(kWidth, kHeight);
  BufferPtr out_ = video_.Black(0);
  Mosaic mosaic_;
  Eigen::Matrix3d screen_from_ground_ = Eigen::Matrix3d::Identity();
};

TEST_F(MosaicTest, TheFirstFrameIsShownAsItIs) {
  Show(Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity());
  EXPECT_LT(Difference(1, kWidth - 1), 0.5);
  EXPECT_EQ(Pixel(kWidth - 1, kHeight - 1), 255);
}

TEST_F(MosaicTest, WhatEarlierFramesShowedStaysWithoutTheirBorders) {
  for (int t = 0; t <= 20; ++t) Show(Shift(2.3 * t, 0.4 * t), Eigen::Matrix3d::Identity());
  // The last frame reaches from column 46 on.
  EXPECT_LT(Difference(2, 46), 3.0);
  EXPECT_LT(Difference(50, kWidth - 2), 3.0);
}

TEST_F(MosaicTest, WhatNoFrameShowedIsBlack) {
  Show(Shift(60.0, 0.0), Eigen::Matrix3d::Identity());
  EXPECT_EQ(Pixel(20, 60), 16);
  EXPECT_NE(Pixel(100, 60), 16);
}

// In smooth mode the screen moves a little with every frame: drawn anew each time, what is kept
// would blur away.
TEST_F(MosaicTest, AMovingScreenKeepsItSharp) {
  Show(Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity());
  for (int t = 1; t <= 60; ++t) {
    Show(Shift(40.0, 0.0), CameraMotion(kWidth, kHeight, 0.001 * std::sin(t), 1.0,
                                        1.0 + 0.3 * std::sin(1.7 * t), 0.4 * std::cos(t)));
  }
  EXPECT_LT(Difference(4, 36), 4.0);
}

TEST_F(MosaicTest, ItFollowsTheScreenOverTheGround) {
  for (int t = 0; t <= 60; ++t) Show(Shift(2.0 * t + 30.0, 0.0), Shift(-2.0 * t, 0.0));
  // The frame lies 30 px to the right of the screen.
  EXPECT_LT(Difference(4, 28), 5.0);
  EXPECT_LT(Difference(36, kWidth - 4), 3.0);
}

TEST_F(MosaicTest, ResetForgets) {
  Show(Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity());
  mosaic_.Reset();
  Show(Shift(60.0, 0.0), Eigen::Matrix3d::Identity());
  EXPECT_EQ(Pixel(20, 60), 16);
}

}  // namespace
}  // namespace windhover
