// SPDX-License-Identifier: Apache-2.0
// The executable as users call it: `windhover register`.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "service/vision/homography.h"
#include "tests/service/app_process.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr int kWidth = 321;
constexpr int kHeight = 243;

class RegisterTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  cv::Mat View(const Eigen::Matrix3d& ground_from_picture, std::uint32_t seed) const {
    const auto backend = Backend::Create("cpu");
    GrayImage image = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
    SyntheticGround().Render(ground_from_picture, 1.0, seed, image);
    cv::Mat picture(kHeight, kWidth, CV_8U);
    const auto mapped = image.Read();
    for (int y = 0; y < kHeight; ++y) {
      std::copy_n(mapped.row(y), kWidth, picture.ptr<std::uint8_t>(y));
    }
    return picture;
  }
  cv::Mat ViewA() const { return View(ground_from_a_, 1); }
  cv::Mat ViewB() const { return View(Eigen::Matrix3d::Identity(), 2); }
  void Write(const std::string& name, const cv::Mat& picture) const {
    ASSERT_TRUE(cv::imwrite(Path(name), picture));
  }

  Outcome Register(const std::string& a, const std::string& b,
                   const std::vector<std::string>& arguments = {}) const {
    std::vector<std::string> command = {WINDHOVER_EXECUTABLE, "register", Path(a), Path(b),
                                        "--device",           "cpu"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return RunToEnd(command);
  }

  // RMS over picture a between b_from_a as printed and the truth, px.
  double Error(const nlohmann::json& result) const {
    Eigen::Matrix3d b_from_a;
    for (int i = 0; i < 9; ++i) b_from_a(i / 3, i % 3) = result["b_from_a"][i].get<double>();
    return HomographyRms(b_from_a, ground_from_a_, kWidth, kHeight);
  }

  static void ExpectRefused(const Outcome& outcome, int exit_code, const std::string& text) {
    EXPECT_EQ(outcome.exit_code, exit_code);
    EXPECT_THAT(outcome.lines, IsEmpty());
    EXPECT_THAT(outcome.errors, HasSubstr(text));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }

  // The ground has the coordinates of b, so this is b_from_a.
  const Eigen::Matrix3d ground_from_a_ = CameraMotion(kWidth, kHeight, 0.04, 1.03, 9.0, -6.0);
  ScratchFolder folder_;
};

TEST_F(RegisterTest, TheHomographyTakesPointsOfAToB) {
  Write("a.png", ViewA());
  Write("b.png", ViewB());
  const Outcome outcome = Register("a.png", "b.png", {"--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  ASSERT_EQ(outcome.lines.size(), 1);
  const auto result = nlohmann::json::parse(outcome.lines[0]);
  EXPECT_EQ(result["quality"], "valid");
  EXPECT_EQ(result["a"], Path("a.png"));
  EXPECT_EQ(result["width"], kWidth);
  EXPECT_EQ(result["height"], kHeight);
  EXPECT_LT(Error(result), 0.2);
  EXPECT_EQ(result["corner_covariance_px2"].size(), 64);
  for (int i = 0; i < 8; ++i) EXPECT_GT(result["corner_covariance_px2"][9 * i], 0.0);
  EXPECT_EQ(result["tiles"], 36);
  EXPECT_DOUBLE_EQ(result["inlier_share"], result["inliers"].get<double>() / 36.0);
  EXPECT_GT(result["overlap"], 0.8);
  EXPECT_LT(result["overlap"], 1.0);
  EXPECT_LT(result["residual_px"], 1.0);
}

TEST_F(RegisterTest, WordsNameConventionAndDeviations) {
  Write("a.png", ViewA());
  Write("b.png", ViewB());
  const Outcome outcome = Register("a.png", "b.png", {"--set", "tile-columns=5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto text = testing::PrintToString(outcome.lines);
  EXPECT_THAT(text, HasSubstr("a.png to "));
  EXPECT_THAT(text, HasSubstr("(321x243 px): valid"));
  EXPECT_THAT(text, HasSubstr("of 30 tiles agree"));
  EXPECT_THAT(text, HasSubstr("b_from_a takes points (x, y) of A to B"));
  EXPECT_THAT(text, HasSubstr("bottom right"));
  EXPECT_EQ(outcome.lines.size(), 11);
}

// 14 bits in 16, as of a thermal camera; colour; JPEG; and each against another kind.
TEST_F(RegisterTest, AnyKindOfPictureGivesTheSameHomography) {
  Write("b.png", ViewB());
  const cv::Mat a = ViewA();
  cv::Mat thermal, colour;
  a.convertTo(thermal, CV_16U, 6.0, 7000.0);
  thermal.at<std::uint16_t>(100, 50) = 65535;
  cv::cvtColor(a, colour, cv::COLOR_GRAY2BGR);
  Write("thermal.png", thermal);
  Write("thermal.tiff", thermal);
  Write("colour.jpg", colour);
  cv::Mat colour16;
  colour.convertTo(colour16, CV_16U, 200.0);
  Write("colour16.png", colour16);
  for (const std::string name : {"thermal.png", "thermal.tiff", "colour.jpg", "colour16.png"}) {
    const Outcome outcome = Register(name, "b.png", {"--json"});
    ASSERT_EQ(outcome.exit_code, 0) << name << outcome.errors;
    EXPECT_LT(Error(nlohmann::json::parse(outcome.lines[0])), 0.2) << name;
  }
}

TEST_F(RegisterTest, WritesPicturesThatShowTheAlignment) {
  // Another exposure: the difference must not show it.
  cv::Mat a = ViewA();
  a.convertTo(a, CV_8U, 0.7, 20.0);
  Write("a.png", a);
  Write("b.png", ViewB());
  const Outcome outcome = Register("a.png", "b.png", {"--json", "--out", Path("out")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(Path("out"))) {
    names.push_back(entry.path().filename());
  }
  EXPECT_THAT(names, UnorderedElementsAre("result.json", "blended.png", "difference.png"));
  std::ifstream file(Path("out/result.json"));
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, outcome.lines[0]);

  const cv::Mat blended = cv::imread(Path("out/blended.png"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(blended.type(), CV_8UC3);
  EXPECT_EQ(blended.size(), cv::Size(kWidth, kHeight));
  const cv::Mat difference = cv::imread(Path("out/difference.png"), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(difference.type(), CV_8U);
  const double aligned = cv::mean(difference)[0];
  cv::Mat plain;
  cv::absdiff(ViewA(), ViewB(), plain);
  EXPECT_LT(aligned, 3.0);
  EXPECT_GT(cv::mean(plain)[0], 3.0 * aligned);
}

TEST_F(RegisterTest, WhatIsNotValidIsSaidAndHasAnExitCodeOfItsOwn) {
  Write("a.png", ViewA());
  Write("b.png", ViewB());
  Write("black.png", cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(0)));
  const std::vector<std::string> arguments = {"--json", "--out", Path("out")};
  ASSERT_EQ(Register("a.png", "b.png", arguments).exit_code, 0);
  for (const auto& [a, b] : {std::pair{"a.png", "black.png"}, {"black.png", "b.png"}}) {
    const Outcome outcome = Register(a, b, arguments);
    EXPECT_EQ(outcome.exit_code, 3) << a << outcome.errors;
    ASSERT_EQ(outcome.lines.size(), 1);
    const auto result = nlohmann::json::parse(outcome.lines[0]);
    EXPECT_EQ(result["quality"], "lost");
    EXPECT_TRUE(result["b_from_a"].is_null());
    EXPECT_TRUE(result["overlap"].is_null());
  }
  // Pictures of the earlier, valid result would contradict the last one.
  EXPECT_FALSE(std::filesystem::exists(Path("out/blended.png")));
  EXPECT_TRUE(std::filesystem::exists(Path("out/result.json")));
  // A quarter of the picture that agrees with itself but not with the rest.
  cv::Mat torn = ViewA();
  ViewA()(cv::Rect(160, 120, 155, 115)).copyTo(torn(cv::Rect(166, 128, 155, 115)));
  Write("torn.png", torn);
  const Outcome degraded = Register("torn.png", "b.png", {"--set", "min-inlier-share=1"});
  EXPECT_EQ(degraded.exit_code, 3);
  EXPECT_THAT(testing::PrintToString(degraded.lines), HasSubstr("degraded"));
}

TEST_F(RegisterTest, BadInputIsNamed) {
  Write("a.png", ViewA());
  Write("small.png", cv::Mat(100, 200, CV_8U, cv::Scalar(9)));
  Write("tiny.png", cv::Mat(8, 9, CV_8U, cv::Scalar(9)));
  Write("float.tiff", cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(0.5)));
  std::ofstream(Path("text.png")) << "no picture";
  ExpectRefused(Register("none.png", "a.png"), 1, "none.png: there is no such file");
  ExpectRefused(Register("a.png", "text.png"), 1, "text.png: not a picture");
  ExpectRefused(Register("a.png", "float.tiff"), 1, "float.tiff: neither 8 nor 16 bits");
  const Outcome sizes = Register("a.png", "small.png", {"--out", Path("out")});
  ExpectRefused(sizes, 1, "a.png has 321x243 px");
  EXPECT_THAT(sizes.errors, HasSubstr("small.png has 200x100 px"));
  EXPECT_FALSE(std::filesystem::exists(Path("out")));
  ExpectRefused(Register("tiny.png", "tiny.png"), 2, "9x8");
  ExpectRefused(Register("a.png", "a.png", {"--set", "k=3"}), 2, "tile-columns");
  ExpectRefused(Register("a.png", "a.png", {"--out", Path("text.png")}), 1, "text.png");
}

}  // namespace
}  // namespace windhover
