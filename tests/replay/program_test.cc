// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "replay/format/horizon.h"
#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "tests/service/app_process.h"

// windhover-replay as people call it.

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Answer {
  int code = -1;
  std::string text;    // standard output and error
  std::string output;  // standard output
};

// Arguments are separated by single blanks.
Answer Call(const std::string& arguments) {
  std::vector<std::string> command = {WINDHOVER_REPLAY};
  for (const std::string_view part : Split(arguments, ' ')) command.emplace_back(part);
  const Outcome outcome = RunToEnd(command);
  Answer answer = {outcome.exit_code, outcome.errors, ""};
  for (const std::string& line : outcome.lines) answer.output += line + "\n";
  answer.text += answer.output;
  return answer;
}

std::string Content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Program, HelpAndVersion) {
  EXPECT_EQ(Call("--version").code, 0);
  for (const char* command :
       {"", "render", "info", "detect", "score motion", "score registration", "bench speed",
        "bench registration", "bench motion", "bench first-frame", "report"}) {
    const Answer answer = Call(std::string(command) + " --help");
    EXPECT_EQ(answer.code, 0) << command;
    EXPECT_THAT(answer.text, HasSubstr("Usage"));
  }
}

TEST(Program, MistakesAreOneClearLine) {
  const ScratchFolder folder;
  const std::string out = " --out " + (folder.path() / "out").string();
  const auto expect = [](const std::string& arguments, const std::string& reason) {
    const Answer answer = Call(arguments);
    EXPECT_NE(answer.code, 0) << arguments;
    EXPECT_THAT(answer.text, AllOf(HasSubstr(reason), Not(HasSubstr("terminate"))));
  };
  expect("", "subcommand");
  expect("render", "--out");
  expect("render --sequence 77" + out, "no sequence '77'");
  expect("render --sequence 1,1" + out, "named twice");
  expect("render --ground nowhere.png" + out, "is no picture");
  expect("render --size 3x4" + out, "3x4");
  expect("render --size 320" + out, "320");
  expect("detect nowhere" + out, "does not exist");
  expect("bench motion --dataset nowhere", "nowhere");
  expect("bench registration --dataset " + folder.path().string(), "holds no sequence");
  expect("detect nowhere --set k=0" + out, "k");
  expect("detect nowhere --set nonsense=1" + out, "nonsense");
  expect("score motion --truth nowhere --detections nothing.txt", "does not exist");
  expect("info nowhere", "does not exist");
  expect("info " + folder.path().string(), "is no sequence, video or known set");
  WriteText(folder.path() / "letter.txt", "dear\n");
  expect("render --frames 1 --out " + folder.path().string(), "not replaced");
  EXPECT_EQ(Content(folder.path() / "letter.txt"), "dear\n");
}

TEST(Program, RendersDetectsAndScores) {
  const ScratchFolder folder;
  const std::string flight = (folder.path() / "flight").string();
  const std::string out = (folder.path() / "out").string();
  const Answer rendered = Call("render --frames 24 --size 320x240 --out " + flight);
  ASSERT_EQ(rendered.code, 0) << rendered.text;
  const std::string detect = "detect " + flight + " --set device=cpu --out ";
  const Answer detected =
      Call(detect + out + " --truth " + flight + " --overlay " + out + "/pictures --every 12");
  ASSERT_EQ(detected.code, 0) << detected.text;
  EXPECT_THAT(detected.text,
              AllOf(HasSubstr("24 frames"), HasSubstr("registration over 23 pairs")));
  EXPECT_TRUE(std::filesystem::exists(out + "/pictures/000013.png"));
  const Answer motion =
      Call("score motion --truth " + flight + " --detections " + out + "/det.txt");
  EXPECT_EQ(motion.code, 0) << motion.text;
  const Answer registration =
      Call("score registration --truth " + flight + " --homographies " + out + "/homography.txt");
  EXPECT_EQ(registration.code, 0) << registration.text;
  EXPECT_THAT(detected.text, AllOf(HasSubstr(motion.text), HasSubstr(registration.text)));

  // Detection does not look at the truth, nor does it vary.
  std::filesystem::remove_all(folder.path() / "flight" / "gt");
  const Answer blind = Call(detect + out + "2");
  ASSERT_EQ(blind.code, 0) << blind.text;
  EXPECT_EQ(Content(out + "/det.txt"), Content(out + "2/det.txt"));
  EXPECT_EQ(Content(out + "/homography.txt"), Content(out + "2/homography.txt"));
}

// The CPU twin's runs are compared above.
TEST(Program, DetectionOnAnOpenClDeviceDoesNotVary) {
  const ScratchFolder folder;
  const std::string flight = (folder / "flight").string();
  ASSERT_EQ(Call("render --frames 30 --size 320x240 --out " + flight).code, 0);
  const std::string out = (folder / "out").string();
  for (const char* run : {"1", "2"}) {
    const Answer answer = Call("detect " + flight + " --set device=:CPU: --out " + out + run);
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_THAT(answer.text, HasSubstr("device: OpenCL CPU"));
  }
  EXPECT_FALSE(Content(out + "1/det.txt").empty());
  EXPECT_EQ(Content(out + "1/det.txt"), Content(out + "2/det.txt"));
  EXPECT_EQ(Content(out + "1/homography.txt"), Content(out + "2/homography.txt"));
}

TEST(Program, ShortRunsAreTheStartOfLongOnes) {
  const ScratchFolder folder;
  const std::string render = "render --size 160x120 --seed 5 --out " + folder.path().string();
  // The suburb is compressed, the outskirts are not.
  const Answer both = Call(render + "/set --sequence 1,suburb --frames 4 --threads 3");
  ASSERT_EQ(both.code, 0) << both.text;
  for (const std::string number : {"01", "10"}) {
    const std::string part = number + "-part";
    const Answer shorter =
        Call(render + "/" + part + " --sequence " + number + " --frames 2 --threads 1");
    ASSERT_EQ(shorter.code, 0) << shorter.text;
    for (const char* file : {"img1/000001.png", "img1/000002.png"}) {
      const std::string content = Content(folder.path() / part / file);
      EXPECT_FALSE(content.empty());
      EXPECT_EQ(content, Content(folder.path() / "set" / number / file)) << number << " " << file;
    }
    const std::string boxes = Content(MoversPath(folder.path() / part));
    EXPECT_EQ(Content(MoversPath(folder.path() / "set" / number)).substr(0, boxes.size()), boxes);
  }
  EXPECT_FALSE(std::filesystem::exists(HorizonPath(folder.path() / "set" / "01")));
}

TEST(Program, TheSkyOfAFlightIsMarked) {
  const ScratchFolder folder;
  const std::filesystem::path valley = folder / "valley";
  const Answer rendered =
      Call("render --sequence valley --size 144x116 --frames 2 --out " + valley.string());
  ASSERT_EQ(rendered.code, 0) << rendered.text;
  const std::vector<Eigen::Vector3d> horizons = ReadHorizons(HorizonPath(valley));
  ASSERT_EQ(horizons.size(), 2U);
  EXPECT_LT(horizons[0].dot(Eigen::Vector3d(72, 0, 1)), -5) << "the picture's top is sky";
  EXPECT_GT(horizons[0].dot(Eigen::Vector3d(72, 60, 1)), 0);
}

// The first frames of a sequence as pictures one after the other: a video that does not say how
// long it is.
void WriteRawVideo(const std::filesystem::path& sequence, int frames,
                   const std::filesystem::path& file) {
  const SequenceInfo info = ReadSequenceInfo(sequence);
  std::ofstream video(file, std::ios::binary);
  for (int frame = 1; frame <= frames; ++frame) {
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(".jpg", cv::imread(FramePath(sequence, info, frame).string()), bytes));
    video.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
  }
}

// A run over fewer frames than the truth has must not look like a good one.
TEST(Program, ASourceThatBreaksOffIsNotScored) {
  const ScratchFolder folder;
  const std::filesystem::path flight = folder / "flight";
  ASSERT_EQ(Call("render --frames 24 --size 160x120 --out " + flight.string()).code, 0);
  const std::filesystem::path video = folder / "flight.mjpeg";
  WriteRawVideo(flight, 20, video);
  const std::string out = (folder / "out").string();
  const std::string detect = "detect " + video.string() + " --set device=cpu --out " + out;
  const std::string truth = " --truth " + flight.string();

  const Answer unscored = Call(detect + "1");
  EXPECT_EQ(unscored.code, 0) << unscored.text;
  EXPECT_THAT(unscored.text, HasSubstr("20 frames"));
  const Answer broken_off = Call(detect + "2" + truth);
  EXPECT_EQ(broken_off.code, 1);
  EXPECT_THAT(broken_off.text, AllOf(HasSubstr("gives 20 frames"), HasSubstr("truth is of 24"),
                                     Not(HasSubstr("precision"))));
  EXPECT_TRUE(std::filesystem::is_empty(out + "2"));
  const Answer start = Call(detect + "3 --frames 20" + truth);
  EXPECT_EQ(start.code, 0) << start.text;
  EXPECT_THAT(start.text, AllOf(HasSubstr("precision"), HasSubstr("registration over 19 pairs")));

  // So is it with results from elsewhere.
  const std::string motion = "score motion --detections " + out + "1/det.txt" + truth;
  const std::string registration =
      "score registration --homographies " + out + "1/homography.txt" + truth;
  const Answer refused = Call(registration);
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.text, AllOf(HasSubstr("of 20 frames"), HasSubstr("truth of 24")));
  EXPECT_EQ(Call(registration + " --frames 21").code, 1);
  EXPECT_THAT(start.text, HasSubstr(Call(registration + " --frames 20").text));
  EXPECT_THAT(Call(registration + " --frames 5").text, HasSubstr("over 4 pairs"));
  EXPECT_THAT(start.text, HasSubstr(Call(motion + " --frames 20").text));
  EXPECT_THAT(Call(motion + " --frames 25").text, HasSubstr("has 24 frames, but 25"));
  WriteText(out + "1/det.txt", "25,1,1,1,5,5,1\n");
  EXPECT_THAT(Call(motion).text, HasSubstr("box in frame 25"));
}

TEST(Program, InfoDescribesWhatIsThere) {
  const ScratchFolder folder;
  const std::filesystem::path flight = folder / "set" / "01";
  ASSERT_EQ(Call("render --frames 12 --size 160x120 --out " + flight.string()).code, 0);
  const Answer one = Call("info " + flight.string());
  ASSERT_EQ(one.code, 0) << one.text;
  EXPECT_THAT(one.text, AllOf(HasSubstr("MOTChallenge: 160x120 px, 12 frames, 25 a second"),
                              HasSubstr("(movers)"), HasSubstr("camera, from truth, 11 pairs"),
                              Not(HasSubstr("measured"))));

  // A video has no truth: what is measured must be what is true of the flight it shows.
  WriteRawVideo(flight, 12, folder / "set" / "flight.mjpeg");
  const std::string set = (folder / "set").string();
  const auto recordings = [](const Answer& answer) {
    return nlohmann::json::parse(answer.output).at("recordings");
  };
  std::filesystem::create_directory(folder / "set" / "02");
  const Answer all = Call("info --json --device cpu " + set);
  ASSERT_EQ(all.code, 0) << all.text;
  const nlohmann::json both = recordings(all);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].at("frame_rate_hz"), 25);
  EXPECT_TRUE(both[0].at("truth").at("homographies"));
  EXPECT_TRUE(both[0].at("camera_measured").is_null());
  EXPECT_EQ(both[1].at("layout"), "video");
  EXPECT_EQ(both[1].at("frames"), 12);
  EXPECT_TRUE(both[1].at("camera_true").is_null());
  const auto median = [](const nlohmann::json& camera, const char* figure) {
    return camera.at(figure).at("median").get<double>();
  };
  EXPECT_NEAR(median(both[1].at("camera_measured"), "shift_px"),
              median(both[0].at("camera_true"), "shift_px"), 0.2);
  EXPECT_NEAR(median(both[1].at("camera_measured"), "rotation_deg"),
              median(both[0].at("camera_true"), "rotation_deg"), 0.1);

  const nlohmann::json measured =
      recordings(Call("info --measure --json --device cpu " + flight.string()));
  EXPECT_NEAR(median(measured[0].at("camera_measured"), "shift_px"),
              median(both[0].at("camera_true"), "shift_px"), 0.2);

  // One that is broken does not hide the others.
  std::filesystem::remove(FramePath(flight, ReadSequenceInfo(flight), 5));
  const Answer broken = Call("info --frames 0 " + set);
  EXPECT_EQ(broken.code, 1);
  EXPECT_THAT(broken.text, AllOf(HasSubstr("000005.png: is missing"), HasSubstr("flight, video"),
                                 HasSubstr("1 of 2 recordings cannot be read")));
}

TEST(Program, WhatIsWrongIsSaidBeforeTheWork) {
  const ScratchFolder folder;
  const std::filesystem::path flight = folder / "flight";
  ASSERT_EQ(Call("render --frames 3 --size 160x120 --out " + flight.string()).code, 0);
  const std::string out = (folder / "out").string();
  const std::string detect = "detect " + flight.string() + " --set device=cpu --out " + out;
  const auto expect = [](const std::string& arguments, const std::string& reason) {
    const Answer answer = Call(arguments);
    EXPECT_EQ(answer.code, 1) << arguments;
    EXPECT_THAT(answer.text, AllOf(HasSubstr(reason), Not(HasSubstr("detecting"))));
  };
  expect(detect + " --truth " + folder.path().string(), "seqinfo.ini: cannot be read");
  const std::filesystem::path truth = folder / "truth";
  std::filesystem::copy(flight, truth, std::filesystem::copy_options::recursive);
  SequenceInfo info = ReadSequenceInfo(truth);
  info.width = 320;
  WriteSequenceInfo(truth, info);
  expect(detect + " --truth " + truth.string(), "is of 160x120 px, but the truth of 320x120");
  info.width = 160;
  info.frames = 2;
  WriteSequenceInfo(truth, info);
  expect(detect + " --truth " + truth.string(), "seqinfo.ini says that there are 2");
  std::filesystem::remove(HomographiesPath(truth));
  WriteText(MoversPath(truth), "1,1,1,1,9,9,1\n");
  expect(detect + " --truth " + truth.string(), "gives 3 frames, but the truth is of 2");
  WriteText(out + "2", "a file\n");
  expect(detect + "2", "out2");
  EXPECT_EQ(Content(out + "2"), "a file\n");
}

// Of one small sequence: that every contestant takes part, and that nothing stands for what is not
// there.
TEST(Program, MeasuresADataset) {
  ::setenv("WINDHOVER_DEVICE", "cpu", 1);
  const ScratchFolder folder;
  const std::string dataset = (folder / "B").string();
  ASSERT_EQ(Call("render --frames 14 --size 320x240 --out " + dataset + "/01").code, 0);
  const std::string arguments =
      " --dataset " + dataset + " --data " + (folder / "nowhere").string() + " --json ";
  const auto measure = [&](const std::string& what) {
    const std::string file = (folder / (what + ".json")).string();
    const Answer answer = Call("bench " + what + arguments + file);
    EXPECT_EQ(answer.code, 0) << answer.text;
    return Content(file);
  };
  const std::string registration = measure("registration");
  for (const char* figure :
       {"registration.rms_px.01", "registration.gap10_rms_px.01", "peer.klt.rms_px.01",
        "peer.orb.rms_px.01", "peer.sift.rms_px.01", "peer.sift_lmeds.rms_px.01",
        "peer.akaze.rms_px.01", "peer.ecc.rms_px.01", "peer.dual.rms_px.01",
        "peer.phase_correlate.rms_px.01", "registration.first_frame_s.warm",
        "registration.table_2_2"}) {
    EXPECT_THAT(registration, HasSubstr('"' + std::string(figure) + '"'));
  }
  EXPECT_THAT(registration, AllOf(Not(HasSubstr("rms_px.mean")), Not(HasSubstr("reach_share")),
                                  HasSubstr("there is no 02"), HasSubstr("CPU twin")));
  const std::string motion = measure("motion");
  for (const char* figure : {"motion.table_6_1", "motion.recall.01", "motion.centre.recall.01",
                             "motion.frame_differencing.recall.01", "peer.mog2.recall.01"}) {
    EXPECT_THAT(motion, HasSubstr('"' + std::string(figure) + '"'));
  }
  EXPECT_THAT(motion, AllOf(Not(HasSubstr("recall.mean")), Not(HasSubstr("motion.real.")),
                            HasSubstr("no uavdt-s1301")));
  ::unsetenv("WINDHOVER_DEVICE");
}

// Whether there is a picture anywhere below; asked while files come and go.
bool HoldsPicture(const std::filesystem::path& folder) {
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (it->path().extension() == ".png") return true;
  }
  return false;
}

// Interrupts the program once `reached` says so, within a minute. Returns what it has said.
template <typename Reached>
std::string Interrupt(Process& program, Reached&& reached) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!reached(program) && std::chrono::steady_clock::now() < limit) std::this_thread::yield();
  EXPECT_TRUE(reached(program)) << program.ErrorText();
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130);
  return program.ErrorText();
}

// Renders `frames` frames until `reached` says so.
template <typename Reached>
std::string InterruptRendering(const ScratchFolder& folder, int frames, Reached&& reached) {
  Process program({WINDHOVER_REPLAY, "render", "--frames", std::to_string(frames), "--size",
                   "320x240", "--out", folder / "flight"});
  return Interrupt(program, reached);
}

TEST(Program, AnInterruptLeavesNoFramesBehind) {
  const ScratchFolder folder;
  const std::string text =
      InterruptRendering(folder, 300, [&](const Process&) { return HoldsPicture(folder.path()); });
  EXPECT_THAT(text, HasSubstr("interrupted; nothing half-written is left"));
  EXPECT_THAT(folder.Names(), testing::IsEmpty());
}

TEST(Program, AnInterruptEndsThePaintingOfTheGround) {
  const ScratchFolder folder;
  const std::string text = InterruptRendering(folder, 5000, [](const Process& program) {
    return program.ErrorText().find("painting") != std::string::npos;
  });
  EXPECT_THAT(text, AllOf(HasSubstr("nothing half-written is left"), Not(HasSubstr("rendering"))));
  EXPECT_THAT(folder.Names(), testing::IsEmpty());
}

TEST(Program, ABenchmarkWithoutDatasetRendersOneThatGoesWithIt) {
  const ScratchFolder folder;
  for (const char* benchmark : {"registration", "motion"}) {
    Process program({WINDHOVER_REPLAY, "bench", benchmark, "--quick"},
                    {"TMPDIR=" + folder.path().string()});
    Interrupt(program, [&](const Process& running) {
      return running.ErrorText().find("painting the ground of 01") != std::string::npos &&
             !folder.Names().empty();
    });
    EXPECT_THAT(folder.Names(), testing::IsEmpty()) << benchmark;
  }
}

}  // namespace
}  // namespace windhover::replay
