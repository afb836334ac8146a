// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "replay/format/homographies.h"
#include "replay/format/labels.h"
#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "tests/replay/picture_folder.h"
#include "tests/service/app_process.h"

// `windhover-replay score` on sequences small enough to count by hand.

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Answer {
  int code = -1;
  std::string text;  // standard output and error
};

// Arguments are separated by single blanks.
Answer Score(const std::string& arguments) {
  std::vector<std::string> command = {WINDHOVER_REPLAY, "score"};
  for (const std::string_view part : Split(arguments, ' ')) command.emplace_back(part);
  const Outcome outcome = RunToEnd(command);
  Answer answer = {outcome.exit_code, outcome.errors};
  for (const std::string& line : outcome.lines) answer.text += line + "\n";
  return answer;
}

nlohmann::json ReadJson(const std::filesystem::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in);
}

LabelledBox At(int frame, std::int64_t id, double x, double y) {
  return {frame, id, {x, y, 10, 10}};
}

Eigen::Matrix3d Shift(double x) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 2) = x;
  return matrix;
}

// Three frames of 64x48 at 25 a second, the camera going 4 px a frame to the right.
void WriteSequence(const std::filesystem::path& folder, const std::vector<LabelledBox>& movers) {
  SequenceInfo info;
  info.name = folder.filename().string();
  info.frames = 3;
  info.width = 64;
  info.height = 48;
  WriteSequenceInfo(folder, info);
  WritePictures(folder / "img1", "", 6, ".png", info.frames);
  WriteTruthBoxes(MoversPath(folder), movers);
  WriteHomographies(HomographiesPath(folder), {Shift(0), Shift(4), Shift(8)});
}

class ScoreProgram : public testing::Test {
 protected:
  // Sequence 01: one of one found. Sequence 02: one of three, beside two false alarms.
  void SetUp() override {
    WriteSequence(folder_ / "B/01", {At(1, 1, 10, 10)});
    WriteDetections(folder_ / "out/01/det.txt", {At(1, 1, 10, 10)});
    WriteHomographies(folder_ / "out/01/homography.txt", {Shift(0), Shift(5), Shift(9)});
    WriteSequence(folder_ / "B/02", {At(1, 1, 10, 10), At(2, 1, 14, 10), At(3, 1, 18, 10)});
    WriteDetections(folder_ / "out/02/det.txt",
                    {At(1, 1, 10, 10), At(1, 2, 40, 10), At(2, 2, 40, 10)});
    WriteHomographies(folder_ / "out/02/homography.txt", {Shift(0), Shift(7), Shift(14)});
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  ScratchFolder folder_;
};

TEST_F(ScoreProgram, OneSequence) {
  const Answer answer = Score("motion --truth " + Path("B/02") + " --detections " +
                              Path("out/02/det.txt") + " --json " + Path("one.json"));
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("3 frames, 3 boxes in truth, 3 detections"),
                                 HasSubstr("overlap 0.05"), HasSubstr("33.3 %"),
                                 HasSubstr("false alarms a minute: 1000.0"),
                                 HasSubstr("1 objects, 0 id switches")));
  const nlohmann::json json = ReadJson(folder_ / "one.json");
  const nlohmann::json& sequence = json.at("sequences").at(0);
  EXPECT_EQ(sequence.at("overlap").size(), 3U);
  EXPECT_EQ(sequence.at("overlap").at(0).at("hits"), 1);
  // 4 px a frame in the picture and as much by the camera: it does 8 px a frame over the ground.
  EXPECT_EQ(sequence.at("recall_by_speed_px_a_frame").at(4).at("truth"), 3);
}

TEST_F(ScoreProgram, ADatasetHasATableWithMeanAndPooled) {
  const Answer answer = Score("motion --truth " + Path("B") + " --detections " + Path("out") +
                              " --overlap 0.5 --json " + Path("all.json"));
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("\n01 "), HasSubstr("\n02 "), HasSubstr("\nmean "),
                                 HasSubstr("\npooled ")));
  const nlohmann::json json = ReadJson(folder_ / "all.json");
  EXPECT_DOUBLE_EQ(json.at("mean").at("overlap").at(0).at("f1"), 2.0 / 3);
  EXPECT_DOUBLE_EQ(json.at("pooled").at("overlap").at(0).at("f1"), 0.5);
  EXPECT_EQ(json.at("pooled").at("overlap").at(0).at("threshold"), 0.5);
}

TEST_F(ScoreProgram, PesmodHasItsOwnRules) {
  WriteDetections(folder_ / "out/01/det.txt", {At(1, 1, 10, 10), At(1, 2, 1, 30)});
  const std::string motion =
      "motion --truth " + Path("B/01") + " --detections " + Path("out/01/det.txt");
  EXPECT_THAT(Score(motion).text, HasSubstr("2 detections"));
  const Answer answer = Score(motion + " --protocol pesmod --json " + Path("pesmod.json"));
  EXPECT_THAT(answer.text, AllOf(HasSubstr("1 detections"), HasSubstr("at overlap 0.5:")));
  EXPECT_EQ(ReadJson(folder_ / "pesmod.json").at("protocol"), "pesmod");
  EXPECT_NE(Score(motion + " --protocol other").code, 0);
}

TEST_F(ScoreProgram, WhatIsAbsentIsNamed) {
  std::filesystem::remove(folder_ / "out/02/det.txt");
  const Answer missing = Score("motion --truth " + Path("B") + " --detections " + Path("out"));
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.text, HasSubstr("02/det.txt: cannot be read"));
  const Answer file =
      Score("motion --truth " + Path("B") + " --detections " + Path("out/01/det.txt"));
  EXPECT_EQ(file.code, 1);
  EXPECT_THAT(file.text, HasSubstr("is no folder"));
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(Score("motion --truth " + Path("empty") + " --detections " + Path("out")).text,
              HasSubstr("empty: is no sequence"));
}

TEST_F(ScoreProgram, RegistrationOfADatasetAndOverAGap) {
  const Answer answer = Score("registration --truth " + Path("B") + " --homographies " +
                              Path("out") + " --gap 2 --json " + Path("registration.json"));
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_THAT(answer.text, AllOf(HasSubstr("\n01 "), HasSubstr("2 frames apart")));
  const nlohmann::json json = ReadJson(folder_ / "registration.json").at("gaps");
  // 01 is wrong by 1 px in its first step, 02 by 3 px in both.
  EXPECT_NEAR(json.at(0).at("sequences").at(0).at("mean_px"), 0.5, 1e-9);
  EXPECT_EQ(json.at(0).at("sequences").at(0).at("failures"), 0);
  EXPECT_NEAR(json.at(0).at("sequences").at(1).at("mean_px"), 3, 1e-9);
  EXPECT_EQ(json.at(0).at("sequences").at(1).at("failures"), 2);
  EXPECT_NEAR(json.at(1).at("sequences").at(1).at("mean_px"), 6, 1e-9);
  EXPECT_NEAR(json.at(0).at("sequences").at(1).at("drift_px"), 6, 1e-9);
}

TEST_F(ScoreProgram, SkyOfASequenceDoesNotCount) {
  Eigen::Matrix3d bent = Shift(4);
  bent(0, 1) = 0.5;  // right in row 0 alone
  WriteHomographies(folder_ / "out/01/homography.txt", {Shift(0), bent, bent * Shift(4)});
  const std::string registration =
      "registration --truth " + Path("B/01") + " --homographies " + Path("out/01/homography.txt");
  EXPECT_THAT(Score(registration).text, HasSubstr("1 over 2 px"));
  WriteText(folder_ / "B/01/gt/horizon.txt", "1 0 -1 1\n2 0 -1 1\n3 0 -1 1\n");
  EXPECT_THAT(Score(registration).text, HasSubstr("max 0.0000 px, 0 over 2 px"));
}

// A picture of rough ground, alike in all directions, `left` px on.
void WriteGround(const std::filesystem::path& file, double left) {
  constexpr int kWaves = 24;
  cv::Mat sum = cv::Mat::zeros(240, 320, CV_64F);
  for (int wave = 0; wave < kWaves; ++wave) {
    const double angle = std::numbers::pi * wave / kWaves;
    const double wave_number = 0.25 + 0.2 * std::fmod(0.618 * wave, 1);
    for (int y = 0; y < sum.rows; ++y) {
      for (int x = 0; x < sum.cols; ++x) {
        sum.at<double>(y, x) +=
            10 * std::sin(wave_number * (std::cos(angle) * (x + left) + std::sin(angle) * y) +
                          2.4 * wave * wave);
      }
    }
  }
  cv::Mat picture;
  sum.convertTo(picture, CV_8U, 1, 128);
  std::filesystem::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), picture));
}

TEST_F(ScoreProgram, AVideoWithoutTruth) {
  std::vector<Eigen::Matrix3d> right;
  std::vector<Eigen::Matrix3d> wrong;
  for (int i = 0; i < 8; ++i) {
    WriteGround(folder_ / ("pictures/00000" + std::to_string(i + 1) + ".png"), 4 * i);
    right.push_back(Shift(4 * i));
    wrong.push_back(Shift(5 * i));
  }
  WriteHomographies(folder_ / "right.txt", right);
  WriteHomographies(folder_ / "wrong.txt", wrong);
  const auto score = [&](const std::string& name) {
    const Answer answer = Score("registration --video " + Path("pictures") + " --homographies " +
                                Path(name + ".txt") + " --gap 3 --every 2 --device cpu --json " +
                                Path(name + ".json"));
    EXPECT_EQ(answer.code, 0) << answer.text;
    EXPECT_THAT(answer.text, HasSubstr("cycles of 3 frames"));
    return ReadJson(folder_ / (name + ".json"));
  };
  const nlohmann::json good = score("right");
  const nlohmann::json bad = score("wrong");
  EXPECT_EQ(good.at("cycles_px").at("count"), 3);
  EXPECT_LT(good.at("cycles_px").at("median"), 0.2);
  EXPECT_NEAR(bad.at("cycles_px").at("median"), 3, 0.2);
  EXPECT_LT(good.at("consecutive").at("misplacement_px").at("median"), 0.2);
  EXPECT_NEAR(bad.at("consecutive").at("misplacement_px").at("median"), 1, 0.2);

  const std::string registration = "registration --video " + Path("pictures") + " --homographies ";
  right.pop_back();
  WriteHomographies(folder_ / "short.txt", right);
  const Answer shorter = Score(registration + Path("short.txt") + " --device cpu");
  EXPECT_EQ(shorter.code, 1);
  EXPECT_THAT(shorter.text, HasSubstr("has more than 7 frames"));
  EXPECT_EQ(Score(registration + Path("short.txt") + " --device cpu --frames 7").code, 0);
  EXPECT_EQ(Score(registration + Path("short.txt") + " --device cpu --frames 8").code, 1);
  EXPECT_NE(Score("registration --homographies " + Path("short.txt")).code, 0);
}

// Labels of another set say nothing of what moves: homographies do.
TEST_F(ScoreProgram, ObjectsThatStandAreLeftOut) {
  std::vector<LabelledBox> objects;
  std::vector<Eigen::Matrix3d> still;
  for (int frame = 1; frame <= 30; ++frame) {
    objects.push_back(At(frame, 1, 20, 20));
    objects.push_back(At(frame, 2, 10 + frame, 5));
    still.push_back(Shift(0));
  }
  const std::filesystem::path folder = folder_ / "mot";
  SequenceInfo info;
  info.name = "mot";
  info.frames = 30;
  info.width = 64;
  info.height = 48;
  WriteSequenceInfo(folder, info);
  WritePictures(folder / "img1", "", 6, ".png", info.frames);
  WriteTruthBoxes(MoversPath(folder), objects);
  WriteDetections(folder_ / "det.txt", {});
  const std::string motion = "motion --truth " + Path("mot") + " --detections " + Path("det.txt");
  const Answer unknown = Score(motion);
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.text, HasSubstr("--homographies"));
  WriteHomographies(folder_ / "still.txt", still);
  EXPECT_THAT(Score(motion + " --homographies " + Path("still.txt")).text,
              HasSubstr("30 boxes in truth"));
}

}  // namespace
}  // namespace windhover::replay
