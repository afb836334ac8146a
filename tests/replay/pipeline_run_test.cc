// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/pipeline_run.h"

#include <gst/gst.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <vector>

#include "replay/offline/detection.h"
#include "service/gstreamer/messages.h"
#include "service/gstreamer/objects.h"
#include "service/gstreamer/start.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

// In all tests of this program another plugin of the same name is installed, where GStreamer looks
// by itself.
class AnotherPluginInstalled : public testing::Environment {
 public:
  void SetUp() override {
    const std::filesystem::path plugins = folder_ / "gstreamer-1.0/plugins";
    std::filesystem::create_directories(plugins);
    std::filesystem::copy_file(WINDHOVER_PLUGIN,
                               plugins / std::filesystem::path(WINDHOVER_PLUGIN).filename());
    ::setenv("XDG_DATA_HOME", folder_.path().c_str(), 1);
    ::setenv("GST_REGISTRY", (folder_ / "registry.bin").c_str(), 1);
    ::unsetenv("GST_PLUGIN_PATH");
    ::unsetenv("GST_PLUGIN_PATH_1_0");
  }

 private:
  const ScratchFolder folder_;
};

const testing::Environment* const another_plugin_installed =
    testing::AddGlobalTestEnvironment(new AnotherPluginInstalled);

TEST(StartGStreamer, TakesThePluginBesideTheProgramFirst) {
  StartGStreamer();
  EXPECT_TRUE(std::filesystem::equivalent(PluginFile(), WINDHOVER_PLUGIN)) << PluginFile();
}

TEST(PlayThroughPipeline, KeepsFramesInOrderWithTheirContent) {
  for (const bool colour : {false, true}) {
    // 18 wide: GStreamer pads its rows, so that planes cannot be copied whole.
    std::vector<cv::Mat> frames;
    for (int i = 0; i < 7; ++i) {
      frames.emplace_back(colour ? cv::Mat(24, 18, CV_8UC3, cv::Scalar(i, 50 + i, 100 + i))
                                 : cv::Mat(36, 18, CV_8UC1, cv::Scalar(10 + i)));
    }
    std::vector<GstClockTime> times;
    std::vector<int> first_bytes;
    PlayThroughPipeline(frames, 25, {"identity ! queue", {}}, [&](GstBuffer* buffer) {
      times.push_back(GST_BUFFER_PTS(buffer));
      std::uint8_t byte = 0;
      gst_buffer_extract(buffer, 0, &byte, 1);
      first_bytes.push_back(byte);
    });
    ASSERT_EQ(times.size(), frames.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      EXPECT_EQ(times[i], i * 40 * GST_MSECOND);
      EXPECT_EQ(first_bytes[i], static_cast<int>(i) + (colour ? 0 : 10));
    }
  }
}

TEST(PlayThroughPipeline, FailuresBecomeExceptions) {
  const std::vector<cv::Mat> frames(5, cv::Mat(24, 16, CV_8UC3, cv::Scalar::all(9)));
  const auto ignore = [](GstBuffer*) {};
  EXPECT_THROW(PlayThroughPipeline(frames, 25, {"no-such-element", {}}, ignore),
               std::runtime_error);
  // Refuses the format: caps cannot be negotiated.
  EXPECT_THROW(PlayThroughPipeline(frames, 25, {"capsfilter caps=audio/x-raw", {}}, ignore),
               std::runtime_error);
  const auto refuse = [](auto) { throw std::runtime_error("no"); };
  EXPECT_THROW(PlayThroughPipeline(frames, 25, {"identity", {}}, refuse), std::runtime_error);
  EXPECT_THROW(PlayThroughPipeline(frames, 25, {"identity", {}}, ignore, refuse),
               std::runtime_error);
}

TEST(PlayThroughPipeline, SaysWhenAFrameEnters) {
  const std::vector<cv::Mat> frames(5, cv::Mat(24, 16, CV_8UC3, cv::Scalar::all(9)));
  std::vector<std::size_t> entered;
  PlayThroughPipeline(
      frames, 25, {"identity", {}}, [](GstBuffer*) {},
      [&](std::size_t frame) { entered.push_back(frame); });
  EXPECT_EQ(entered, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

// A picture of blocks that is shifted from frame to frame, under a dot with a way of its own.
std::filesystem::path WriteVideo(const ScratchFolder& folder) {
  cv::Mat blocks(100, 150, CV_8UC3);
  cv::randu(blocks, 0, 255);
  cv::Mat ground;
  cv::resize(blocks, ground, {}, 4, 4, cv::INTER_CUBIC);
  std::filesystem::path file = folder / "video.avi";
  cv::VideoWriter writer(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                         {320, 240});
  for (int i = 0; i < 30; ++i) {
    cv::Mat frame = ground(cv::Rect(4 * i, 3 * i, 320, 240)).clone();
    cv::rectangle(frame, {40 + i, 100 - 2 * i, 12, 8}, cv::Scalar::all(i % 2 == 0 ? 255 : 240), -1);
    writer.write(frame);
  }
  return file;
}

// Without queues, so that all is done by one thread, and with the decoder that decodebin finds.
std::vector<FrameOutcome> LaunchByHand(const std::filesystem::path& video) {
  const std::string text =
      "filesrc location=" + video.string() +
      " ! decodebin ! videoconvert ! whregister device=cpu ! whbackground device=cpu ! whmotion "
      "! fakesink name=sink sync=false signal-handoffs=true";
  const ObjectPtr<GstElement> pipeline(gst_parse_launch(text.c_str(), nullptr));
  const ObjectPtr<GstElement> sink(gst_bin_get_by_name(GST_BIN(pipeline.get()), "sink"));
  std::vector<FrameOutcome> outcomes;
  g_signal_connect(sink.get(), "handoff",
                   G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, gpointer to) {
                     static_cast<std::vector<FrameOutcome>*>(to)->push_back(OutcomeOf(buffer));
                   }),
                   &outcomes);
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  const ObjectPtr<GstBus> bus(gst_element_get_bus(pipeline.get()));
  EXPECT_EQ(AwaitEnd(bus.get()), "");
  gst_element_set_state(pipeline.get(), GST_STATE_NULL);
  return outcomes;
}

TEST(DetectInSource, SeesWhatAPipelineByHandSees) {
  const ScratchFolder folder;
  const std::filesystem::path video = WriteVideo(folder);
  const std::vector<FrameOutcome> ours =
      DetectInSource(video, {{{"device", "cpu"}}, 0, {}},
                     {[](const DetectionState&) {}, [](const std::string&) {}});
  const std::vector<FrameOutcome> by_hand = LaunchByHand(video);
  ASSERT_EQ(ours.size(), 30u);
  ASSERT_EQ(by_hand.size(), ours.size());
  std::size_t boxes = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].registration.frame_number, i);
    EXPECT_EQ(ours[i].registration.previous_from_frame,
              by_hand[i].registration.previous_from_frame);
    if (i > 0) {
      const Eigen::Matrix3d& motion = ours[i].registration.previous_from_frame;
      EXPECT_NEAR(motion(0, 2), 4, 0.1) << i;
      EXPECT_NEAR(motion(1, 2), 3, 0.1) << i;
    }
    ASSERT_EQ(ours[i].detections.size(), by_hand[i].detections.size()) << i;
    for (std::size_t d = 0; d < ours[i].detections.size(); ++d, ++boxes) {
      EXPECT_EQ(ours[i].detections[d].box.x, by_hand[i].detections[d].box.x);
      EXPECT_EQ(ours[i].detections[d].track_id, by_hand[i].detections[d].track_id);
    }
  }
  EXPECT_GT(boxes, 10u);
}

}  // namespace
}  // namespace windhover::replay
