// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

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
  std::string text;  // standard output and error
};

// Arguments are separated by single blanks.
Answer Call(const std::string& arguments) {
  std::vector<std::string> command = {WINDHOVER_REPLAY};
  for (const std::string_view part : Split(arguments, ' ')) command.emplace_back(part);
  const Outcome outcome = RunToEnd(command);
  Answer answer = {outcome.exit_code, outcome.errors};
  for (const std::string& line : outcome.lines) answer.text += line + "\n";
  return answer;
}

std::string Content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Program, HelpAndVersion) {
  EXPECT_EQ(Call("--version").code, 0);
  for (const char* command :
       {"", "render", "detect", "score motion", "score registration", "bench speed"}) {
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
  expect("render --size 3x4" + out, "3x4");
  expect("render --size 320" + out, "320");
  expect("detect nowhere" + out, "does not exist");
  expect("detect nowhere --set k=0" + out, "k");
  expect("detect nowhere --set nonsense=1" + out, "nonsense");
  expect("score motion --truth nowhere --detections nothing.txt", "cannot be read");
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

TEST(Program, AnInterruptLeavesNothingBehind) {
  const ScratchFolder folder;
  Process program({WINDHOVER_REPLAY, "render", "--frames", "5000", "--size", "320x240", "--out",
                   folder / "flight"});
  // The first frames lie in the hidden neighbour by the time the progress is told.
  while (program.ErrorText().find("painting") == std::string::npos) std::this_thread::yield();
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130);
  EXPECT_THAT(program.ErrorText(), HasSubstr("interrupted"));
  EXPECT_TRUE(folder.Names().empty());
}

}  // namespace
}  // namespace windhover::replay
