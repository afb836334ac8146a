// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <thread>
#include <vector>

#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "tests/service/app_process.h"

// windhover-replay detect as people call it, on one small rendered flight.

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kFrames = 30;
constexpr int kBroken = 14;  // the frame that tests break

std::string Content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class DetectTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    rendered_ = new ScratchFolder;
    const Outcome outcome = RunToEnd({WINDHOVER_REPLAY, "render", "--frames", "30", "--size",
                                      "320x240", "--out", *rendered_ / "flight"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
  static void TearDownTestSuite() { delete rendered_; }

  // A copy to break.
  fs::path Flight() const {
    const fs::path flight = folder_ / "flight";
    if (!fs::exists(flight)) {
      fs::copy(*rendered_ / "flight", flight, fs::copy_options::recursive);
    }
    return flight;
  }
  fs::path Picture(int frame) const {
    return FramePath(Flight(), ReadSequenceInfo(Flight()), frame);
  }
  // All frames as Motion JPEG.
  fs::path Video() const {
    fs::path file = folder_ / "flight.avi";
    cv::VideoWriter writer(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                           {320, 240});
    for (int frame = 1; frame <= kFrames; ++frame) {
      writer.write(cv::imread(Picture(frame).string()));
    }
    return file;
  }

  Outcome Detect(const fs::path& source, const std::string& out,
                 const std::vector<std::string>& more = {}) const {
    std::vector<std::string> command = {WINDHOVER_REPLAY, "detect", source,      "--out",
                                        folder_ / out,    "--set",  "device=cpu"};
    command.insert(command.end(), more.begin(), more.end());
    return RunToEnd(command);
  }
  void ExpectSameResults(const std::string& one, const std::string& other) const {
    for (const char* file : {"det.txt", "homography.txt"}) {
      EXPECT_FALSE(Content(folder_ / one / file).empty()) << one << " " << file;
      EXPECT_EQ(Content(folder_ / one / file), Content(folder_ / other / file)) << other << file;
    }
  }
  void ExpectRefused(const fs::path& source, const std::string& reason,
                     const std::vector<std::string>& more = {}) const {
    const Outcome outcome = Detect(source, "refused", more);
    EXPECT_EQ(outcome.exit_code, 1) << reason;
    EXPECT_THAT(outcome.errors, HasSubstr(reason));
    EXPECT_TRUE(!fs::exists(folder_ / "refused") || fs::is_empty(folder_ / "refused")) << reason;
  }

  ScratchFolder folder_;

 private:
  static ScratchFolder* rendered_;
};

ScratchFolder* DetectTest::rendered_ = nullptr;

TEST_F(DetectTest, TheTruthIsNeverOpened) {
  const fs::path gt = Flight() / "gt";
  ASSERT_EQ(Detect(Flight(), "with").exit_code, 0);
  // Whoever reads these fails.
  for (const fs::directory_entry& file : fs::directory_iterator(gt)) {
    WriteText(file.path(), "no truth\n");
  }
  ASSERT_EQ(Detect(Flight(), "poisoned").exit_code, 0);
  fs::remove_all(gt);
  ASSERT_EQ(Detect(Flight(), "without").exit_code, 0);
  ExpectSameResults("with", "poisoned");
  ExpectSameResults("with", "without");
}

TEST_F(DetectTest, AnAnnotatedVideoHasEveryFrameAndChangesNothing) {
  ASSERT_EQ(Detect(Flight(), "plain").exit_code, 0);
  ASSERT_EQ(Detect(Flight(), "drawn", {"--video"}).exit_code, 0);
  ExpectSameResults("plain", "drawn");
  EXPECT_FALSE(fs::exists(folder_ / "plain" / "annotated.mp4"));
  cv::VideoCapture video((folder_ / "drawn" / "annotated.mp4").string(), cv::CAP_FFMPEG);
  int frames = 0;
  for (cv::Mat frame; video.read(frame); ++frames) EXPECT_EQ(frame.size(), cv::Size(320, 240));
  EXPECT_EQ(frames, kFrames);
}

TEST_F(DetectTest, TheFirstFramesOfASourceAreThoseOfAShorterOne) {
  const fs::path video = Video();
  for (const fs::path& source : {Flight(), video}) {
    const std::string name = source == video ? "video" : "sequence";
    const Outcome outcome = Detect(source, name, {"--frames", "20"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.lines.at(0), HasSubstr("20 frames"));
  }
  SequenceInfo info = ReadSequenceInfo(Flight());
  info.frames = 20;
  WriteSequenceInfo(Flight(), info);
  ASSERT_EQ(Detect(Flight(), "shorter").exit_code, 0);
  ExpectSameResults("sequence", "shorter");
}

TEST_F(DetectTest, AFolderWithOneVideoIsThatVideo) {
  ASSERT_EQ(Detect(Video(), "file").exit_code, 0);
  fs::create_directory(folder_ / "set");
  fs::copy(folder_ / "flight.avi", folder_ / "set");
  ASSERT_EQ(Detect(folder_ / "set", "folder").exit_code, 0);
  ExpectSameResults("file", "folder");
  // As the frames of a sequence it must be as long as the sequence says.
  SequenceInfo info = ReadSequenceInfo(Flight());
  WriteSequenceInfo(folder_ / "set", info);
  ASSERT_EQ(Detect(folder_ / "set", "sequence").exit_code, 0);
  ExpectSameResults("file", "sequence");
  ++info.frames;
  WriteSequenceInfo(folder_ / "set", info);
  ExpectRefused(folder_ / "set", "gives 30 frames, but seqinfo.ini says 31");
}

TEST_F(DetectTest, ABrokenPictureIsNamed) {
  const std::string name = Picture(kBroken).string();
  const std::string whole = Content(Picture(kBroken));
  const std::string no_picture = name + ": the frame is missing or no picture";
  WriteText(name, whole.substr(0, whole.size() / 2));
  ExpectRefused(Flight(), no_picture);
  EXPECT_EQ(Detect(Flight(), "before", {"--frames", std::to_string(kBroken - 1)}).exit_code, 0);
  WriteText(name, "no picture\n");
  ExpectRefused(Flight(), no_picture);
  WriteText(name, "");
  ExpectRefused(Flight(), no_picture, {"--video"});
  fs::remove(name);
  ExpectRefused(Flight(), name + " is missing");
  cv::Mat smaller;
  cv::resize(cv::imread(Picture(1).string()), smaller, {240, 180});
  cv::imwrite(name, smaller);
  ExpectRefused(Flight(), name + ": is of 240x180 px, but the sequence of 320x240");
  ExpectRefused(Flight(), "is of 240x180 px", {"--video"});
  WriteText(name, whole);
  WriteText(Picture(kFrames), "no picture\n");
  ExpectRefused(Flight(), Picture(kFrames).string() + ": the frame is missing or no picture");
  fs::remove_all(Flight());
  SequenceInfo info = ReadSequenceInfo(Flight());
  info.height = 200;
  WriteSequenceInfo(Flight(), info);
  ExpectRefused(Flight(), Picture(1).string() + ": is of 320x240 px, but the sequence of 320x200");
}

TEST_F(DetectTest, AVideoThatBreaksOffIsRefused) {
  const std::string whole = Content(Video());
  WriteText(folder_ / "cut.avi", whole.substr(0, whole.size() / 2));
  ExpectRefused(folder_ / "cut.avi", "cut.avi: is cut off: ");
  EXPECT_EQ(Detect(folder_ / "cut.avi", "start", {"--frames", "5"}).exit_code, 0);
  WriteText(folder_ / "letter.avi", "dear\n");
  ExpectRefused(folder_ / "letter.avi", "letter.avi: not a video");
}

TEST_F(DetectTest, WrongOptionsAreNamed) {
  ExpectRefused(Flight(), "there is no option 'nonsense'", {"--set", "nonsense=1"});
  ExpectRefused(Flight(), "expected option=value, got 'k'", {"--set", "k"});
  ExpectRefused(Flight(), "option k: '0' is not a number from 1", {"--set", "k=0"});
  ExpectRefused(Flight(), "nothing-like-it", {"--set", "device=nothing-like-it"});
  ExpectRefused(Flight(), "too small for 25x6 tiles", {"--set", "tile-columns=25"});
}

TEST_F(DetectTest, AnInterruptLeavesNothingHalfWritten) {
  // Long enough for a signal to come in the middle.
  const Outcome doubled = RunToEnd({WINDHOVER_REPLAY, "render", "--frames", "300", "--size",
                                    "160x120", "--out", folder_ / "long"});
  ASSERT_EQ(doubled.exit_code, 0) << doubled.errors;
  Process program({WINDHOVER_REPLAY, "detect", folder_ / "long", "--out", folder_ / "out",
                   "--video", "--set", "device=cpu", "--set", "reference=centre"});
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (program.ErrorText().find("detecting") == std::string::npos &&
         std::chrono::steady_clock::now() < limit) {
    std::this_thread::yield();
  }
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130);
  EXPECT_THAT(program.ErrorText(),
              AllOf(HasSubstr("interrupted"), Not(HasSubstr("detecting 300"))));
  EXPECT_TRUE(fs::is_empty(folder_ / "out"));
}

}  // namespace
}  // namespace windhover::replay
