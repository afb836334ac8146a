// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "gst-plugins/luma.h"
#include "gst-plugins/video_frame_map.h"
#include "service/gstreamer/detection_meta.h"
#include "service/gstreamer/homography_meta.h"
#include "service/vision/homography.h"
#include "tests/gst-plugins/harness.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

constexpr int kWidth = 321;
constexpr int kHeight = 241;
constexpr char kRegister[] = "whregister device=cpu tile-columns=4 tile-rows=4 ! whstabilize ";

// A camera that hovers and shakes: some 10 px, half a degree, a percent.
Eigen::Matrix3d ShakingCamera(int t) {
  return CameraMotion(kWidth, kHeight, 0.01 * std::sin(1.9 * t), 1.0 + 0.008 * std::sin(1.3 * t),
                      8.0 * std::sin(1.1 * t), 6.0 * std::sin(2.3 * t));
}

// On its way it turns and sways, too, but slowly.
Eigen::Matrix3d SwayingCamera(int t) {
  return CameraMotion(kWidth, kHeight, 0.05 * std::sin(0.1 * t), 1.0, 3.0 * t, 0.0) *
         ShakingCamera(t);
}

cv::Mat_<float> LumaOf(const TestVideo& video, const BufferPtr& buffer) {
  const int width = GST_VIDEO_INFO_WIDTH(&video.info());
  const int height = GST_VIDEO_INFO_HEIGHT(&video.info());
  GrayImage gray = Backend::Create("cpu")->MakeImage<std::uint8_t>(width, height);
  const VideoFrameMap map(video.info(), buffer.get(), GST_MAP_READ);
  ExtractLuma(map.frame(), gray);
  const auto view = gray.Read();
  cv::Mat_<float> luma(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) luma(y, x) = view.at(x, y);
  }
  return luma;
}

// The largest shift between two pictures, of five patches well inside.
double LargestShift(const cv::Mat_<float>& a, const cv::Mat_<float>& b) {
  constexpr int kPatch = 64;
  cv::Mat window;
  cv::createHanningWindow(window, {kPatch, kPatch}, CV_32F);
  double largest = 0.0;
  for (const auto& [x, y] : {std::pair{130, 90}, {50, 50}, {200, 50}, {50, 130}, {200, 130}}) {
    const cv::Rect patch(x, y, kPatch, kPatch);
    const cv::Point2d shift = cv::phaseCorrelate(a(patch).clone(), b(patch).clone(), window);
    largest = std::max(largest, std::hypot(shift.x, shift.y));
  }
  return largest;
}

std::vector<BufferPtr> Stabilised(TestVideo& video, const std::string& options, int frames) {
  Harness harness(kRegister + options);
  harness.SetCaps(video.Caps());
  std::vector<BufferPtr> out;
  for (int t = 0; t < frames; ++t) {
    EXPECT_EQ(harness.Push(video.Frame(t)), GST_FLOW_OK);
    for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
  }
  harness.PushEvent(gst_event_new_eos());
  for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
  EXPECT_TRUE(harness.Errors().empty());
  return out;
}

class StabilizeFormatTest : public testing::TestWithParam<GstVideoFormat> {};

TEST_P(StabilizeFormatTest, TheGroundIsHeldStill) {
  const GstVideoFormat format = GetParam();
  TestVideo video(kWidth, kHeight, format,
                  format == GST_VIDEO_FORMAT_NV12 ? Layout::kWithMeta : Layout::kTight);
  video.SetCamera(ShakingCamera);
  // What goes out lies as the caps alone say.
  const TestVideo tight(kWidth, kHeight, format);
  for (const char* border : {"black", "mosaic"}) {
    const auto out = Stabilised(video, std::string("border=") + border, 16);
    ASSERT_EQ(out.size(), 16u);
    const cv::Mat_<float> first = LumaOf(tight, out[0]);
    double before = 0.0;
    for (int t = 1; t < 16; ++t) {
      EXPECT_LT(LargestShift(first, LumaOf(tight, out[t])), 0.3) << border << " " << t;
      before = std::max(before, LargestShift(first, LumaOf(video, video.Frame(t))));
    }
    EXPECT_GT(before, 5.0) << "there was something to hold";
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, StabilizeFormatTest,
                         testing::Values(GST_VIDEO_FORMAT_GRAY8, GST_VIDEO_FORMAT_NV12,
                                         GST_VIDEO_FORMAT_I420, GST_VIDEO_FORMAT_BGR,
                                         GST_VIDEO_FORMAT_BGRx, GST_VIDEO_FORMAT_RGB,
                                         GST_VIDEO_FORMAT_RGBx),
                         [](const auto& info) { return gst_video_format_to_string(info.param); });

class StabilizeElementTest : public testing::Test {
 protected:
  StabilizeElementTest() { video_.SetCamera(ShakingCamera); }

  // Positions of the entries in what came out.
  static std::ptrdiff_t At(const Harness& harness, const std::string& entry) {
    const auto& log = harness.log();
    return std::find(log.begin(), log.end(), entry) - log.begin();
  }

  TestVideo video_{kWidth, kHeight};
};

// Across several anchors, and while the camera goes on its way.
TEST_F(StabilizeElementTest, SmoothModeTakesTheShakingOut) {
  video_.SetCamera(SwayingCamera);
  constexpr int kFrames = 50;
  for (const int lookahead : {0, 10}) {
    const auto out =
        Stabilised(video_, "mode=smooth smoothing-lookahead=" + std::to_string(lookahead), kFrames);
    ASSERT_EQ(out.size(), static_cast<std::size_t>(kFrames));
    // Of the shifts from frame to frame, measured in the pictures: how much they change.
    const auto jitter = [](const std::vector<cv::Mat_<float>>& pictures) {
      const cv::Rect middle(97, 57, 128, 128);
      cv::Mat window;
      cv::createHanningWindow(window, middle.size(), CV_32F);
      double energy = 0.0;
      cv::Point2d last;
      for (std::size_t t = 25; t < pictures.size(); ++t) {
        const cv::Point2d shift = cv::phaseCorrelate(pictures[t - 1](middle).clone(),
                                                     pictures[t](middle).clone(), window);
        if (t > 25) energy += (shift - last).dot(shift - last);
        last = shift;
      }
      return energy;
    };
    std::vector<cv::Mat_<float>> before;
    std::vector<cv::Mat_<float>> after;
    for (int t = 0; t < kFrames; ++t) {
      before.push_back(LumaOf(video_, video_.Frame(t)));
      after.push_back(LumaOf(video_, out[t]));
    }
    EXPECT_GT(jitter(before), (lookahead == 0 ? 20.0 : 80.0) * jitter(after)) << lookahead;
  }
}

TEST_F(StabilizeElementTest, FramesKeepTimesFlagsAndMetadata) {
  for (const char* mode : {"anchor", "smooth smoothing-lookahead=4"}) {
    Harness harness(std::string(kRegister) + "mode=" + mode);
    harness.SetCaps(video_.Caps());
    const std::size_t held = std::string(mode) == "anchor" ? 0 : 4;
    std::vector<BufferPtr> out;
    for (std::size_t t = 0; t < 12; ++t) {
      BufferPtr in = video_.Frame(static_cast<int>(t));
      GST_BUFFER_FLAG_SET(in.get(), t == 5 ? GST_BUFFER_FLAG_GAP : GST_BUFFER_FLAG_MARKER);
      GstCaps* clock = gst_caps_new_empty_simple("timestamp/x-test");
      gst_buffer_add_reference_timestamp_meta(in.get(), clock, t, GST_CLOCK_TIME_NONE);
      gst_caps_unref(clock);
      ASSERT_EQ(harness.Push(std::move(in)), GST_FLOW_OK);
      for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
      EXPECT_EQ(out.size(), t < held ? 0 : t + 1 - held);
    }
    EXPECT_TRUE(harness.PushEvent(gst_event_new_eos()));
    for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
    ASSERT_EQ(out.size(), 12u);
    EXPECT_EQ(harness.log().back(), "eos");
    for (std::size_t t = 0; t < 12; ++t) {
      GstBuffer* buffer = out[t].get();
      EXPECT_EQ(GST_BUFFER_PTS(buffer), TestVideo::kFirstPts + t * TestVideo::kFrameTime);
      EXPECT_EQ(GST_BUFFER_DURATION(buffer), TestVideo::kFrameTime);
      EXPECT_EQ(GST_BUFFER_OFFSET(buffer), t);
      EXPECT_EQ(GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP), t == 5);
      EXPECT_EQ(GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_MARKER), t != 5);
      const auto* stamp = gst_buffer_get_reference_timestamp_meta(buffer, nullptr);
      ASSERT_NE(stamp, nullptr);
      EXPECT_EQ(stamp->timestamp, t);
      const auto* meta = gst_buffer_get_windhover_homography_meta(buffer);
      ASSERT_NE(meta, nullptr);
      EXPECT_EQ(meta->registration.frame_number, t);
      EXPECT_EQ(meta->registration.starts_segment, t == 0);
    }
  }
}

// The homographies that go out speak of the pictures that go out.
TEST_F(StabilizeElementTest, HomographiesSpeakOfTheStabilisedPicture) {
  const auto out = Stabilised(video_, "mode=anchor", 8);
  for (const BufferPtr& buffer : out) {
    const auto& registration = gst_buffer_get_windhover_homography_meta(buffer.get())->registration;
    EXPECT_LT(HomographyRms(registration.previous_from_frame, Eigen::Matrix3d::Identity(), kWidth,
                            kHeight),
              1e-6);
  }
}

TEST_F(StabilizeElementTest, DetectionsStayOnWhatTheyMark) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  const Eigen::Vector2d x_on_ground(100.0, 90.0);
  std::vector<Detection> detections;
  for (int t = 0; t < 8; ++t) {
    BufferPtr in = video_.Frame(t);
    const Eigen::Vector2d x = Project(InverseHomography(ShakingCamera(t)), x_on_ground);
    AddDetections(in.get(), {{1, {x.x() - 4.5, x.y() - 4.5, 10.0, 10.0}, {0, 0}, 1.0, 1}}, kWidth,
                  kHeight);
    ASSERT_EQ(harness.Push(std::move(in)), GST_FLOW_OK);
    const BufferPtr out = harness.Pull();
    GetDetections(out.get(), kWidth, kHeight, detections);
    ASSERT_EQ(detections.size(), 1u);
    const Box& box = detections[0].box;
    // At rest the screen shows the ground as the first frame does.
    const Eigen::Vector2d expected = Project(InverseHomography(ShakingCamera(0)), x_on_ground);
    EXPECT_NEAR(box.x + 0.5 * (box.width - 1.0), expected.x(), 0.3);
    EXPECT_NEAR(box.y + 0.5 * (box.height - 1.0), expected.y(), 0.3);
  }
}

TEST_F(StabilizeElementTest, BordersAreAsAskedFor) {
  video_.SetCamera([](int t) { return CameraMotion(kWidth, kHeight, 0.0, 1.0, 4.0 * t, 0.0); });
  std::vector<cv::Mat_<float>> last;
  for (const char* border : {"black", "replicate", "mosaic"}) {
    const auto out = Stabilised(video_, std::string("border=") + border, 10);
    last.push_back(LumaOf(video_, out.back()));
    if (last.size() == 1) last.insert(last.begin(), LumaOf(video_, out.front()));
  }
  const cv::Mat_<float>&first = last[0], &black = last[1], &replicate = last[2], &mosaic = last[3];
  // The last frame begins at column 36.
  const cv::Rect uncovered(4, 4, 28, kHeight - 8);
  const auto difference = [&](const cv::Mat& a, const cv::Mat& b) {
    return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
  };
  EXPECT_EQ(cv::norm(black(uncovered), cv::NORM_INF), 0.0);
  EXPECT_LT(difference(mosaic(uncovered), first(uncovered)), 4.0);
  for (int x = 4; x < 30; ++x) {
    EXPECT_EQ(cv::norm(replicate.col(x), replicate.col(4), cv::NORM_INF), 0.0);
  }
  EXPECT_GT(difference(replicate(uncovered), first(uncovered)), 8.0);
  const cv::Rect covered(44, 4, 200, kHeight - 8);
  for (const auto& picture : {black, replicate, mosaic}) {
    EXPECT_LT(difference(picture(covered), first(covered)), 3.0);
  }
}

TEST_F(StabilizeElementTest, LatencyFollowsTheLookahead) {
  for (const auto& [options, frames] : {std::pair{"mode=anchor smoothing-lookahead=9", 0},
                                        {"mode=smooth smoothing-lookahead=0", 0},
                                        {"mode=smooth smoothing-lookahead=7", 7},
                                        {"mode=smooth smoothing-lookahead=50 smoothing=0.4", 10}}) {
    Harness harness(std::string(kRegister) + options);
    harness.SetCaps(video_.Caps());
    EXPECT_EQ(harness.Latency(), frames * TestVideo::kFrameTime) << options;
  }
  Harness measured(std::string(kRegister) + "mode=smooth smoothing-lookahead=3");
  measured.SetCaps(video_.Caps(false));
  EXPECT_EQ(measured.Latency(), 0u);
  for (int t = 0; t < 2; ++t) measured.Push(video_.Frame(t));
  EXPECT_EQ(measured.Latency(), 3 * TestVideo::kFrameTime);
}

TEST_F(StabilizeElementTest, EventsKeepTheirPlaceBetweenFrames) {
  Harness harness(std::string(kRegister) + "mode=smooth smoothing-lookahead=3");
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 10; ++t) {
    harness.Push(video_.Frame(t));
    if (t == 4) {
      harness.PushEvent(
          gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty("mark")));
    }
  }
  EXPECT_EQ(At(harness, "custom-downstream"), At(harness, "b4") + 1);
  EXPECT_EQ(At(harness, "b5"), At(harness, "b4") + 2);
}

TEST_F(StabilizeElementTest, AFlushDropsWhatIsHeldAndStartsAnew) {
  Harness harness(std::string(kRegister) + "mode=smooth smoothing-lookahead=3");
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  ASSERT_EQ(harness.PullAll().size(), 3u);
  harness.Flush();
  for (int t = 20; t < 26; ++t) EXPECT_EQ(harness.Push(video_.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 6u);
  EXPECT_EQ(GST_BUFFER_OFFSET(out[0].get()), 20u);
  EXPECT_TRUE(gst_buffer_get_windhover_homography_meta(out[0].get())->registration.starts_segment);
}

TEST_F(StabilizeElementTest, NewCapsDrainTheOldFrames) {
  Harness harness(std::string(kRegister) + "mode=smooth smoothing-lookahead=4");
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  TestVideo smaller(200, 140, GST_VIDEO_FORMAT_I420);
  harness.SetCaps(smaller.Caps());
  EXPECT_LT(At(harness, "b5"), std::ssize(harness.log()));
  for (int t = 6; t < 12; ++t) EXPECT_EQ(harness.Push(smaller.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 12u);
  EXPECT_EQ(gst_buffer_get_size(out[5].get()), GST_VIDEO_INFO_SIZE(&video_.info()));
  EXPECT_EQ(gst_buffer_get_size(out[6].get()), GST_VIDEO_INFO_SIZE(&smaller.info()));
}

// Black frames cannot be registered: no error, and afterwards the pictures come back to rest.
TEST_F(StabilizeElementTest, LostFramesPassAndThePictureComesBack) {
  for (const char* mode : {"anchor", "smooth"}) {
    Harness harness(std::string(kRegister) + "smoothing=0.4 smoothing-lookahead=0 mode=" + mode);
    harness.SetCaps(video_.Caps());
    std::vector<BufferPtr> out;
    for (int t = 0; t < 40; ++t) {
      const bool dark = t >= 12 && t < 15;
      video_.SetCamera([t](int) { return ShakingCamera(t < 15 ? t : 15); });
      ASSERT_EQ(harness.Push(dark ? video_.Black(t) : video_.Frame(t)), GST_FLOW_OK);
      for (BufferPtr& buffer : harness.PullAll()) out.push_back(std::move(buffer));
    }
    ASSERT_EQ(out.size(), 40u);
    EXPECT_TRUE(harness.Errors().empty());
    EXPECT_LT(LargestShift(LumaOf(video_, out[39]), LumaOf(video_, video_.Frame(39))), 0.3) << mode;
  }
}

TEST_F(StabilizeElementTest, NeedsRegistration) {
  Harness harness("whstabilize");
  harness.SetCaps(video_.Caps());
  EXPECT_EQ(harness.Push(video_.Frame(0)), GST_FLOW_ERROR);
  const auto errors = harness.Errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(errors[0].text, testing::HasSubstr("whregister before it"));
}

TEST_F(StabilizeElementTest, RunsAgainAfterReady) {
  Harness harness(std::string(kRegister) + "mode=smooth smoothing-lookahead=2");
  GstElement* bin = harness.get()->element;
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 6; ++t) harness.Push(video_.Frame(t));
  harness.PullAll();
  gst_element_set_state(bin, GST_STATE_READY);
  gst_element_set_state(bin, GST_STATE_PLAYING);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  harness.PushEvent(gst_event_new_stream_start("again"));
  harness.SetCaps(video_.Caps());
  harness.PushEvent(gst_event_new_segment(&segment));
  for (int t = 0; t < 6; ++t) EXPECT_EQ(harness.Push(video_.Frame(t)), GST_FLOW_OK);
  harness.PushEvent(gst_event_new_eos());
  EXPECT_EQ(harness.PullAll().size(), 6u);
}

}  // namespace
}  // namespace windhover
