// SPDX-License-Identifier: Apache-2.0
// The executable as users call it: `windhover run`, `devices` and `warmup`.

#include <gmock/gmock.h>
#include <gst/gst.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/service/app_process.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Runs a pipeline as gst-launch-1.0 does, to make a test video.
void Make(const std::string& pipeline) {
  gst_init(nullptr, nullptr);
  GError* error = nullptr;
  GstElement* element = gst_parse_launch(pipeline.c_str(), &error);
  ASSERT_EQ(error, nullptr) << error->message;
  gst_element_set_state(element, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(element);
  GstMessage* end = gst_bus_timed_pop_filtered(
      bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  ASSERT_NE(end, nullptr);
  EXPECT_EQ(GST_MESSAGE_TYPE(end), GST_MESSAGE_EOS) << pipeline;
  gst_message_unref(end);
  gst_object_unref(bus);
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
}

std::string Video(int frames, int width, int height, const std::string& pattern = "smpte") {
  return "videotestsrc num-buffers=" + std::to_string(frames) + " pattern=" + pattern +
         " ! video/x-raw,format=I420,framerate=25/1,width=" + std::to_string(width) +
         ",height=" + std::to_string(height) + " ";
}

class RunTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Out() const { return Path("out"); }

  // A motion JPEG in AVI or MOV, whichever the name says.
  void MakeVideo(const std::string& name, int frames, int width, int height,
                 const std::string& pattern = "smpte") const {
    const bool avi = fs::path(name).extension() == ".avi";
    Make(Video(frames, width, height, pattern) + "! jpegenc ! " + (avi ? "avimux" : "qtmux") +
         (avi ? "" : " faststart=true") + " ! filesink location=" + Path(name));
  }

  void Cut(const std::string& name, double share) const {
    fs::resize_file(Path(name), static_cast<std::uintmax_t>(
                                    share * static_cast<double>(fs::file_size(Path(name)))));
  }

  // On the CPU twin, so that no kernel need be compiled.
  std::vector<std::string> Command(const std::string& source,
                                   const std::vector<std::string>& arguments = {}) const {
    std::vector<std::string> command = {WINDHOVER_EXECUTABLE, "run", source, "--out", Out(),
                                        "--log-level",        "warn"};
    if (std::find(arguments.begin(), arguments.end(), "--device") == arguments.end()) {
      command.insert(command.end(), {"--device", "cpu"});
    }
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }

  Outcome Run(const std::string& source, const std::vector<std::string>& arguments = {}) const {
    return RunToEnd(Command(source, arguments));
  }

  // One line of error that says so, the exit code, and no file.
  void ExpectRefused(const Outcome& outcome, int exit_code, const std::string& text) const {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr(text));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_THAT(outcome.lines, IsEmpty());
    EXPECT_THAT(Results(), IsEmpty());
  }

  std::vector<std::string> Results() const {
    std::vector<std::string> names;
    if (!fs::exists(Out())) return names;
    for (const auto& entry : fs::directory_iterator(Out())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  std::vector<nlohmann::json> Detections() const {
    std::vector<nlohmann::json> frames;
    std::ifstream file(Out() + "/detections.jsonl");
    for (std::string line; std::getline(file, line);) frames.push_back(nlohmann::json::parse(line));
    return frames;
  }

  // One summary line with that many frames everywhere.
  static void ExpectSummary(const Outcome& outcome, int frames) {
    ASSERT_EQ(outcome.lines.size(), 1);
    const std::string n = std::to_string(frames);
    EXPECT_THAT(outcome.lines[0], HasSubstr(": " + n + " frames in, " + n + " out; homographies " +
                                            n + " published, " + n + " received; detections " + n +
                                            " published, " + n + " received; "));
    EXPECT_THAT(outcome.lines[0], HasSubstr(" frames/s; CPU twin"));
  }

  ScratchFolder folder_;
};

TEST_F(RunTest, WritesALineAndAPictureForEachFrame) {
  MakeVideo("flight.avi", 40, 320, 240);
  const Outcome outcome = Run(Path("flight.avi"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  ExpectSummary(outcome, 40);
  EXPECT_THAT(Results(), ElementsAre("annotated.mp4", "detections.jsonl"));
  const auto frames = Detections();
  ASSERT_EQ(frames.size(), 40);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i]["type"], "detections");
    EXPECT_EQ(frames[i]["stream"], "flight");
    EXPECT_EQ(frames[i]["frame"], i);
    EXPECT_EQ(frames[i]["pts_ns"], i * 40'000'000);
    EXPECT_EQ(frames[i]["width"], 320);
  }
  // The annotated video can be read again, with all its frames.
  const Outcome again = Run(Out() + "/annotated.mp4", {"--no-video"});
  EXPECT_EQ(again.exit_code, 0) << again.errors;
  ExpectSummary(again, 40);
}

TEST_F(RunTest, SizesMayBeOdd) {
  MakeVideo("odd.avi", 12, 321, 241);
  const Outcome outcome = Run(Path("odd.avi"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  ExpectSummary(outcome, 12);
}

TEST_F(RunTest, TakesOptionsOfEveryElement) {
  MakeVideo("flight.avi", 12, 320, 240);
  const Outcome outcome =
      Run(Path("flight.avi"), {"--no-video", "--set", "stream=alpha", "--set", "tile-columns=4",
                               "--set", "k=3", "--set", "lookahead=2", "--set", "reference=centre",
                               "--set", "min-area=20", "--set", "boxes=false"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  ExpectSummary(outcome, 12);
  EXPECT_THAT(Results(), ElementsAre("detections.jsonl"));
  EXPECT_EQ(Detections().at(0)["stream"], "alpha");
}

TEST_F(RunTest, ReadsASequenceOfPictures) {
  fs::create_directories(folder_ / "seq" / "img1");
  Make(Video(15, 320, 240) + "! videoconvert ! pngenc ! multifilesink index=1 location=" +
       Path("seq") + "/img1/%06d.png");
  std::ofstream(Path("seq") + "/seqinfo.ini")
      << "[Sequence]\nname=seq\nimDir=img1\nframeRate=25\nseqLength=15\nimWidth=320\n"
         "imHeight=240\nimExt=.png\n";
  const Outcome outcome = Run(Path("seq"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  ExpectSummary(outcome, 15);
  EXPECT_EQ(Detections().at(14)["pts_ns"], 14 * 40'000'000);
  EXPECT_EQ(Detections().at(14)["stream"], "seq");
}

TEST_F(RunTest, BlackVideoHasNoDetections) {
  MakeVideo("black.avi", 30, 320, 240, "black");
  const Outcome outcome = Run(Path("black.avi"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  ExpectSummary(outcome, 30);
  EXPECT_THAT(outcome.lines[0], HasSubstr("; 0 boxes;"));
}

TEST_F(RunTest, RefusesWhatIsNoVideo) {
  ExpectRefused(Run(Path("none.mp4")), 1, "none.mp4: no such file");
  std::ofstream(Path("empty.mp4")).flush();
  ExpectRefused(Run(Path("empty.mp4")), 1, "empty.mp4 is empty");
  std::ofstream(Path("noise.mp4")) << std::string(5000, '\x9b');
  ExpectRefused(Run(Path("noise.mp4")), 1, "noise.mp4: not a video");
  std::string text;
  for (int line = 0; line < 200; ++line) text += "This is a text about kestrels.\n";
  std::ofstream(Path("text.mp4")) << text;
  ExpectRefused(Run(Path("text.mp4")), 1, "text.mp4: not a video");
  Make("audiotestsrc num-buffers=20 ! wavenc ! filesink location=" + Path("sound.wav"));
  ExpectRefused(Run(Path("sound.wav")), 1, "sound.wav: There is no video in it");
  fs::create_directories(Path("folder"));
  ExpectRefused(Run(Path("folder")), 1, "without seqinfo.ini");
}

// A socket cannot be opened as a file by anybody.
TEST_F(RunTest, RefusesWhatCannotBeRead) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = Path("socket.mp4");
  ASSERT_LT(path.size(), sizeof(address.sun_path));
  path.copy(address.sun_path, path.size());
  const int socket_file = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(socket_file, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ExpectRefused(Run(path), 1, "cannot be read");
  close(socket_file);
}

// The frames that are there are processed, and the results kept.
TEST_F(RunTest, SaysHowFarACutOffFileGoes) {
  MakeVideo("cut.mov", 50, 320, 240);
  Cut("cut.mov", 0.5);
  const Outcome mov = Run(Path("cut.mov"));
  EXPECT_EQ(mov.exit_code, 1);
  EXPECT_TRUE(std::regex_search(
      mov.errors, std::regex("cut.mov is cut off: it ends after (0\\.[89]|1\\.[01])\\d s of 2.00 "
                             "s, 2\\d frames\n$")))
      << mov.errors;
  EXPECT_EQ(mov.lines.size(), 1);
  EXPECT_THAT(Results(), ElementsAre("annotated.mp4", "detections.jsonl"));
  MakeVideo("cut.avi", 50, 320, 240);
  Cut("cut.avi", 0.5);
  const Outcome avi = Run(Path("cut.avi"));
  EXPECT_EQ(avi.exit_code, 1);
  EXPECT_THAT(avi.errors, HasSubstr("cut.avi is cut off: "));
}

TEST_F(RunTest, RefusesFramesThatAreTooSmall) {
  MakeVideo("small.avi", 5, 32, 32);
  ExpectRefused(Run(Path("small.avi")), 1, "too small");
}

TEST_F(RunTest, RefusesUnknownDevicesAndOptions) {
  MakeVideo("flight.avi", 5, 320, 240);
  ExpectRefused(Run(Path("flight.avi"), {"--device", "nowhere:GPU:7"}), 1, "nowhere:GPU:7");
  ExpectRefused(Run(Path("flight.avi"), {"--set", "nonsense=1"}), 2, "nonsense");
  ExpectRefused(Run(Path("flight.avi"), {"--set", "k=0"}), 2, "1 to 40");
  ExpectRefused(Run(Path("flight.avi"), {"--set", "k"}), 2, "option=value");
  ExpectRefused(Run(Path("flight.avi"), {"--set", "reference=middle"}), 2, "middle");
  ExpectRefused(Run(Path("flight.avi"), {"--nonsense"}), 2, "--nonsense");
}

TEST_F(RunTest, FrameSizesMayOnlyChangeWithoutVideo) {
  // Two pictures of different sizes in one stream of pictures.
  fs::create_directories(folder_ / "seq" / "img1");
  Make(Video(6, 320, 240) + "! videoconvert ! pngenc ! multifilesink index=1 location=" +
       Path("seq") + "/img1/%06d.png");
  Make(Video(6, 400, 300) + "! videoconvert ! pngenc ! multifilesink index=7 location=" +
       Path("seq") + "/img1/%06d.png");
  std::ofstream(Path("seq") + "/seqinfo.ini")
      << "[Sequence]\nimDir=img1\nframeRate=25\nseqLength=12\nimExt=.png\n";
  const Outcome video = Run(Path("seq"));
  EXPECT_EQ(video.exit_code, 1);
  EXPECT_THAT(video.errors, HasSubstr("Frame 7 is of 400x300 px, the first one of 320x240"));
  EXPECT_THAT(Results(), IsEmpty());
  const Outcome no_video = Run(Path("seq"), {"--no-video"});
  EXPECT_EQ(no_video.exit_code, 0) << no_video.errors;
  ExpectSummary(no_video, 12);
  EXPECT_EQ(Detections().at(5)["width"], 320);
  EXPECT_EQ(Detections().at(6)["width"], 400);
}

TEST_F(RunTest, InterruptLeavesWholeResults) {
  // Longer than anybody waits: only the interrupt ends it.
  MakeVideo("long.avi", 3000, 320, 240);
  Process run(Command(Path("long.avi")));
  // Once a sample is on the bus, frames flow.
  Process watch({WINDHOVER_EXECUTABLE, "watch", "--json", "--stream", "long", "--topics",
                 "detections", "--log-level", "warn"});
  std::string line;
  while (line.find("\"detections\"") == std::string::npos) {
    const auto next = watch.ReadLine();
    ASSERT_TRUE(next.has_value()) << run.ErrorText();
    line = *next;
  }
  watch.Signal(SIGINT);
  EXPECT_EQ(watch.Wait(), 0);
  run.Signal(SIGINT);
  const std::vector<std::string> lines = run.ReadLines();
  EXPECT_EQ(run.Wait(), 130);
  EXPECT_THAT(run.ErrorText(), HasSubstr("interrupted after"));
  ASSERT_EQ(lines.size(), 1);
  std::smatch counts;
  ASSERT_TRUE(
      std::regex_search(lines[0], counts,
                        std::regex("(\\d+) frames in, \\1 out; homographies \\1 published, \\1 "
                                   "received; detections \\1 published, \\1 received")))
      << lines[0];
  EXPECT_LT(std::stoi(counts[1]), 3000);
  EXPECT_EQ(Detections().size(), std::stoul(counts[1]));
  EXPECT_THAT(Results(), ElementsAre("annotated.mp4", "detections.jsonl"));
  const Outcome again = Run(Out() + "/annotated.mp4", {"--no-video"});
  ExpectSummary(again, std::stoi(counts[1]));
}

// A camera that takes the call and says nothing.
TEST_F(RunTest, InterruptBeforeTheFirstFrameEndsAtOnce) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string uri = "rtsp://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/live";
  Process run(Command(uri));
  pollfd call{listener, POLLIN, 0};
  ASSERT_EQ(poll(&call, 1, 60000), 1) << run.ErrorText();
  const int camera = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
  run.Signal(SIGINT);
  EXPECT_THAT(run.ReadLines(), IsEmpty());
  EXPECT_EQ(run.Wait(), 130);
  EXPECT_THAT(run.ErrorText(), testing::EndsWith("windhover: " + uri + ": interrupted\n"));
  EXPECT_THAT(Results(), IsEmpty());
  close(camera);
  close(listener);
}

TEST_F(RunTest, RunsIntoOneFolderDoNotMeet) {
  MakeVideo("flight.avi", 40, 320, 240);
  Process first(Command(Path("flight.avi")));
  Process second(Command(Path("flight.avi")));
  for (Process* run : {&first, &second}) {
    EXPECT_EQ(run->ReadLines().size(), 1);
    EXPECT_EQ(run->Wait(), 0) << run->ErrorText();
  }
  EXPECT_THAT(Results(), ElementsAre("annotated.mp4", "detections.jsonl"));
  EXPECT_EQ(Detections().size(), 40);
  ExpectSummary(Run(Out() + "/annotated.mp4", {"--no-video"}), 40);
}

TEST(CommandTest, EveryCommandHasHelpAndVersion) {
  for (const char* name : {"", "run", "watch", "devices", "warmup"}) {
    std::vector<std::string> command = {WINDHOVER_EXECUTABLE};
    if (*name != '\0') command.emplace_back(name);
    command.emplace_back("--version");
    const Outcome version = RunToEnd(command);
    EXPECT_EQ(version.exit_code, 0) << name;
    EXPECT_THAT(version.lines, ElementsAre(testing::StartsWith("windhover ")));
    command.back() = "--help";
    const Outcome help = RunToEnd(command);
    EXPECT_EQ(help.exit_code, 0) << name;
    EXPECT_THAT(help.lines, testing::Contains(HasSubstr("--help")));
    EXPECT_THAT(help.errors, IsEmpty());
  }
}

TEST(CommandTest, WrongCommandsAreNamed) {
  const Outcome none = RunToEnd({WINDHOVER_EXECUTABLE});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, HasSubstr("run, register, watch, devices or warmup"));
  const Outcome wrong = RunToEnd({WINDHOVER_EXECUTABLE, "fly"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("fly"));
}

TEST(CommandTest, DevicesMarksTheOneThatIsUsed) {
  const Outcome outcome = RunToEnd({WINDHOVER_EXECUTABLE, "devices", "--device", "cpu"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.lines, testing::Contains("* CPU twin"));
  EXPECT_THAT(outcome.lines.back(), HasSubstr("asked for as 'cpu'"));
  const Outcome variable = RunToEnd({WINDHOVER_EXECUTABLE, "devices"}, {"WINDHOVER_DEVICE=cpu"});
  EXPECT_THAT(variable.lines.back(), HasSubstr("WINDHOVER_DEVICE is 'cpu'"));
  const Outcome unknown = RunToEnd({WINDHOVER_EXECUTABLE, "devices", "--device", "x:CPU:9"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.errors, HasSubstr("x:CPU:9"));
}

TEST(CommandTest, WarmupSaysWhenItIsReady) {
  const Outcome outcome = RunToEnd({WINDHOVER_EXECUTABLE, "warmup", "--device", "cpu"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.lines.back(), HasSubstr("ready on CPU twin"));
}

}  // namespace
}  // namespace windhover
