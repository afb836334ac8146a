// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/pipeline_run.h"

#include <gst/gst.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <vector>

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
}

}  // namespace
}  // namespace windhover::replay
