// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "replay/baselines/klt_registration.h"
#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/figures.h"
#include "replay/benchmarks/motion_results.h"
#include "replay/benchmarks/registration_results.h"
#include "replay/benchmarks/stress_pairs.h"
#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Optional;

std::optional<double> ValueOf(const std::vector<Figure>& figures, const std::string& name) {
  for (const Figure& figure : figures) {
    if (figure.name == name) return figure.value;
  }
  return std::nullopt;
}

TEST(Figures, BecomeOneDocument) {
  BenchmarkDocument document;
  document.device = "CPU twin";
  document.options = {{"k", "10"}};
  AddFigure(document.figures, "a.b", 1.5, "px");
  AddFigure(document.figures, "a.c", std::nullopt, "px");
  document.tables = {{"t", "A table", {"", "x", "n"}, {{"row", 2.25, 3}, {"other", {}, {}}}, 1}};
  document.left_out = {"the rest"};
  const auto json = nlohmann::json::parse(JsonText(document));
  EXPECT_GE(json["machine"]["cores"], 1);
  EXPECT_GT(json["machine"]["memory_gib"], 0);
  EXPECT_FALSE(json["machine"]["processor"].get<std::string>().empty());
  EXPECT_EQ(json["device"], "CPU twin");
  EXPECT_TRUE(json["dataset_sha256"].is_null());
  EXPECT_EQ(json["options"]["k"], "10");
  ASSERT_EQ(json["figures"].size(), 1);
  EXPECT_EQ(json["figures"][0], nlohmann::json({{"name", "a.b"}, {"value", 1.5}, {"unit", "px"}}));
  EXPECT_EQ(json["tables"][0]["columns"], nlohmann::json({"", "x", "n"}));
  EXPECT_EQ(json["tables"][0]["rows"][0], nlohmann::json({"row", 2.25, 3}));
  EXPECT_EQ(json["tables"][0]["rows"][1], nlohmann::json({"other", nullptr, nullptr}));
  EXPECT_EQ(json["left_out"], nlohmann::json({"the rest"}));
  EXPECT_EQ(TableText(document.tables[0]),
            "A table\n"
            "         x  n\n"
            "row    2.2  3\n"
            "other    -  -\n");
}

TEST(Figures, ThatAreNoNumbersAreRefused) {
  BenchmarkDocument document;
  AddFigure(document.figures, "a", std::numeric_limits<double>::infinity());
  EXPECT_THROW(JsonText(document), std::invalid_argument);
  document.figures.clear();
  document.tables = {{"t", "A table", {"x", "y"}, {{1.0}}, 1}};
  EXPECT_THROW(JsonText(document), std::invalid_argument);
}

const BenchmarkProgress kSilent = {[](const std::string&) {}, [] {}};

TEST(Dataset, IsFoundAndHasOneChecksum) {
  const ScratchFolder folder;
  EXPECT_THROW(FindSequences(folder.path()), FormatError);
  EXPECT_THROW(FindSequences(folder.path() / "nowhere"), FormatError);
  for (const char* file : {"02/seqinfo.ini", "01/seqinfo.ini", "01/gt/gt.txt", "notes/text",
                           ".01.pending-1/seqinfo.ini"}) {
    WriteText(folder.path() / file, "text of " + std::string(file));
  }
  const std::vector<DatasetSequence> sequences = FindSequences(folder.path());
  ASSERT_EQ(sequences.size(), 2);
  EXPECT_EQ(sequences[0].id, "01");
  EXPECT_EQ(sequences[1].folder, folder.path() / "02");
  EXPECT_EQ(AbsentSequences(sequences).size(), 8);

  // By sha256sum, of "01/gt/gt.txt", 0, "20", 0, "text of 01/gt/gt.txt", "01/seqinfo.ini", 0, ...
  const std::string sum = DatasetSha256(sequences, kSilent);
  EXPECT_EQ(sum, "cebec5fd566c9808d6bcc0beb08f421b8a3ed4c02b45258d2d5f7dd6121e748c");
  WriteText(folder.path() / "notes/text", "other");
  EXPECT_EQ(DatasetSha256(sequences, kSilent), sum);
  WriteText(folder.path() / "01/gt/gt.txt", "text of 01/gt/gt.tyt");
  EXPECT_NE(DatasetSha256(sequences, kSilent), sum);
}

TEST(Dataset, AnInterruptEndsTheChecksum) {
  const ScratchFolder folder;
  WriteText(folder.path() / "01/seqinfo.ini", "text");
  const BenchmarkProgress interrupted = {[](const std::string&) {},
                                         [] { throw std::runtime_error("interrupted"); }};
  EXPECT_THROW(DatasetSha256(FindSequences(folder.path()), interrupted), std::runtime_error);
}

Eigen::Matrix3d Shift(double x, double y) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 2) = x;
  matrix(1, 2) = y;
  return matrix;
}

TEST(PairRms, CountsWhatWasNotFoundAsTheIdentity) {
  EXPECT_THAT(PairRms(Shift(3, 4), Shift(0, 0), 640, 480), Optional(DoubleNear(5, 1e-9)));
  EXPECT_THAT(PairRms(std::nullopt, Shift(6, 8), 640, 480), Optional(DoubleNear(10, 1e-9)));
  // Homographies are known up to a factor.
  EXPECT_THAT(PairRms(-2.5 * Shift(3, 4), -7 * Shift(0, 0), 640, 480),
              Optional(DoubleNear(5, 1e-9)));
  // No worse than the diagonal.
  EXPECT_THAT(PairRms(Shift(9000, 0), Shift(0, 0), 640, 480), Optional(DoubleNear(800, 1e-9)));
  EXPECT_EQ(PairRms(Shift(0, 0), Shift(700, 0), 640, 480), std::nullopt);
}

TEST(NormalisedCornerError, IsOneForAnErrorOfOneStandardDeviation) {
  FrameRegistration registration;
  registration.previous_from_frame = Shift(0.5, 0.5);
  registration.corner_covariance.setIdentity();
  registration.corner_covariance *= 0.25;  // 0.5 px each
  EXPECT_THAT(NormalisedCornerError(registration, Shift(0, 0), 640, 480),
              Optional(DoubleNear(1, 1e-9)));
  // In anchor mode the covariance is that of the anchor's homography.
  registration.anchor_from_frame = Shift(1, 1);
  EXPECT_THAT(NormalisedCornerError(registration, Shift(0, 0), 640, 480),
              Optional(DoubleNear(4, 1e-9)));
  registration.corner_covariance.setZero();
  EXPECT_EQ(NormalisedCornerError(registration, Shift(0, 0), 640, 480), std::nullopt);
}

RegistrationResults HandMade(int sequences) {
  RegistrationResults results;
  results.contestants = {{"", "windhover", {}, {}, {}}, {"klt", "KLT", {}, {}, {}}};
  for (int i = 0; i < sequences; ++i) {
    const std::string& id = TenSequences()[i];
    results.contestants[0].consecutive[id] = {{0.1 * (i + 1), 0.1 * (i + 1)}, {4, 5}};
    results.contestants[1].consecutive[id] = {{0.5, 3.5}, {2}};
    results.contestants[0].ten_apart[id] = {{0.2, 5.0}, {}};
    results.layouts[36][id] = {{0.25}, {}};
  }
  results.contestants[0].reach = {{"shift", {4, 3}}, {"noise", {4, 4}}};
  results.flagged_bad = {{"a", {2, 1}}, {"b", {2, 2}}};
  results.flagged_good = {{"a", {10, 0}}};
  results.corner_errors = {{2, {0.5, 1.5}}, {5, {4.0}}};
  return results;
}

TEST(RegistrationResults, BecomeFigures) {
  const std::vector<Figure> figures = RegistrationFigures(HandMade(10));
  EXPECT_THAT(ValueOf(figures, "registration.rms_px.mean"), Optional(DoubleNear(0.55, 1e-12)));
  EXPECT_THAT(ValueOf(figures, "registration.rms_px.max"), Optional(DoubleNear(1.0, 1e-12)));
  EXPECT_THAT(ValueOf(figures, "registration.rms_px.03"), Optional(DoubleNear(0.3, 1e-12)));
  EXPECT_THAT(ValueOf(figures, "registration.failures"), Optional(0));
  EXPECT_THAT(ValueOf(figures, "registration.gap10_rms_px.mean"), Optional(DoubleNear(2.6, 1e-12)));
  EXPECT_THAT(ValueOf(figures, "registration.gap10_failures"), Optional(10));
  EXPECT_THAT(ValueOf(figures, "registration.reach_share"), Optional(DoubleEq(7.0 / 8)));
  EXPECT_THAT(ValueOf(figures, "registration.reach_share.shift"), Optional(DoubleEq(0.75)));
  EXPECT_THAT(ValueOf(figures, "registration.flagged_bad_share"), Optional(DoubleEq(0.75)));
  EXPECT_THAT(ValueOf(figures, "registration.flagged_good_share"), Optional(0));
  EXPECT_THAT(ValueOf(figures, "registration.nees_ratio"), Optional(DoubleEq(2)));
  EXPECT_THAT(ValueOf(figures, "registration.nees_ratio.noise_2"), Optional(DoubleEq(1)));
  EXPECT_THAT(ValueOf(figures, "peer.klt.rms_px.mean"), Optional(DoubleEq(2)));
  EXPECT_THAT(ValueOf(figures, "peer.klt.failures"), Optional(10));
  EXPECT_THAT(ValueOf(figures, "peer.klt.median_ms"), Optional(2));
}

TEST(RegistrationResults, WhatWasNotMeasuredIsAbsent) {
  const std::vector<Figure> nine = RegistrationFigures(HandMade(9));
  EXPECT_TRUE(ValueOf(nine, "registration.rms_px.09"));
  for (const char* name :
       {"registration.rms_px.mean", "registration.rms_px.max", "registration.rms_px.10",
        "registration.failures", "registration.gap10_rms_px.mean", "peer.klt.rms_px.mean",
        "peer.klt.gap10_rms_px.mean", "peer.klt.reach_share", "registration.first_frame_s.warm"}) {
    EXPECT_FALSE(ValueOf(nine, name)) << name;
  }
}

TEST(RegistrationResults, StandBesideTheThesis) {
  const std::vector<FigureTable> tables = RegistrationTables(HandMade(2));
  ASSERT_FALSE(tables.empty());
  EXPECT_EQ(tables[0].name, "registration.table_2_2");
  EXPECT_THAT(tables[0].columns, ElementsAre("sequence", "of", "36"));
  using Row = std::vector<TableCell>;
  EXPECT_THAT(tables[0].rows, ElementsAre(Row{"01", "windhover", 0.25}, Row{"01", "thesis", 0.33},
                                          Row{"02", "windhover", 0.25}, Row{"02", "thesis", 0.40}));
}

MotionResults HandMadeMotion(int sequences) {
  MotionResults results;
  results.contestants = {{"motion.", "windhover", {}},
                         {"motion.centre.", "centre", {}},
                         {"motion.frame_differencing.", "FD", {}}};
  for (int i = 0; i < sequences; ++i) {
    const std::string& id = TenSequences()[i];
    results.contestants[0].scores[id] = {{{10, 8, 8}, {10, 8, 6}, {10, 8, 0}}};
    results.contestants[1].scores[id] = {{{10, 10, 10}, {}, {}}};
    results.contestants[2].scores[id] = {{{10, i == 0 ? 0 : 20, i == 0 ? 0 : 5}, {}, {}}};
  }
  results.real = {{"set", 4, 6, {0.5, 0.25, 0}}, {"still", 4, 2, {}}};
  return results;
}

TEST(MotionResults, BecomeFigures) {
  const std::vector<Figure> figures = MotionFigures(HandMadeMotion(10));
  EXPECT_THAT(ValueOf(figures, "motion.precision.mean"), Optional(1));
  EXPECT_THAT(ValueOf(figures, "motion.recall.min"), Optional(DoubleEq(0.8)));
  EXPECT_THAT(ValueOf(figures, "motion.recall.07"), Optional(DoubleEq(0.8)));
  EXPECT_THAT(ValueOf(figures, "motion.f1_025.pooled"), Optional(DoubleEq(12.0 / 18)));
  EXPECT_THAT(ValueOf(figures, "motion.f1_05.pooled"), Optional(0));
  EXPECT_THAT(ValueOf(figures, "motion.centre_minus_anchor"),
              Optional(DoubleNear(1 - 16.0 / 18, 1e-12)));
  // Nothing was detected in the first sequence: no precision, but a recall.
  EXPECT_FALSE(ValueOf(figures, "motion.frame_differencing.precision.01"));
  EXPECT_THAT(ValueOf(figures, "motion.frame_differencing.precision.mean"),
              Optional(DoubleEq(0.25)));
  EXPECT_THAT(ValueOf(figures, "motion.frame_differencing.recall.mean"), Optional(DoubleEq(0.45)));
  EXPECT_THAT(ValueOf(figures, "motion.real.set.boxes_per_frame"), Optional(1.5));
  EXPECT_THAT(ValueOf(figures, "motion.real.set.recall_025"), Optional(0.25));
  EXPECT_FALSE(ValueOf(figures, "motion.real.still.recall_005"));
  EXPECT_FALSE(ValueOf(figures, "motion.s1.f1_005"));
  EXPECT_FALSE(ValueOf(MotionFigures(HandMadeMotion(9)), "motion.precision.mean"));
  EXPECT_FALSE(ValueOf(MotionFigures(HandMadeMotion(9)), "motion.centre_minus_anchor"));
}

// A ground of blobs at many scales.
cv::Mat Ground(std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat sum = cv::Mat::zeros(480, 640, CV_32F);
  for (int cell = 64; cell >= 2; cell /= 2) {
    cv::Mat coarse(480 / cell + 2, 640 / cell + 2, CV_32F);
    random.fill(coarse, cv::RNG::UNIFORM, -1, 1);
    cv::Mat fine;
    cv::resize(coarse, fine, {640, 480}, 0, 0, cv::INTER_CUBIC);
    sum += 12 * fine;
  }
  cv::Mat picture;
  sum.convertTo(picture, CV_8U, 1, 110);
  return picture;
}

const cv::Size kCut(400, 300);

TEST(StressPairs, AreTrueToTheirHomography) {
  const cv::Mat ground = Ground(1);
  for (const Stress stress : kStresses) {
    const std::optional<StressPair> pair = CutStressPair(ground, kCut, stress, 0.2, 5);
    ASSERT_TRUE(pair) << NameOf(stress);
    EXPECT_EQ(pair->frame.size(), kCut);
    KltRegistration klt;
    klt.Register(pair->reference);
    const std::optional<Eigen::Matrix3d> found = klt.Register(pair->frame);
    ASSERT_TRUE(found) << NameOf(stress);
    if (stress == Stress::kCombined) continue;  // beyond KLT
    EXPECT_LT(*PairRms(found, *pair->reference_from_frame, kCut.width, kCut.height), 0.2)
        << NameOf(stress);
  }
}

// The singular values of the linear part are the scale, its angle the rotation.
TEST(StressPairs, GoToTheirLimits) {
  const cv::Mat ground = Ground(1);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto of = [&](Stress stress) {
      return CutStressPair(ground, kCut, stress, 1, seed)->reference_from_frame.value();
    };
    const Eigen::Vector3d middle(199.5, 149.5, 1);
    const Eigen::Matrix3d shift = of(Stress::kShift);
    EXPECT_NEAR((shift * middle - middle).norm(), 140, 1e-9);
    const Eigen::Matrix3d rotation = of(Stress::kRotation);
    EXPECT_NEAR(std::abs(std::atan2(rotation(1, 0), rotation(0, 0))), 10 * CV_PI / 180, 1e-9);
    EXPECT_NEAR(std::abs(of(Stress::kScale)(0, 0) - 1), 0.1, 1e-9);
    EXPECT_TRUE(of(Stress::kGain).isIdentity(1e-9));
    const std::optional<StressPair> gained = CutStressPair(ground, kCut, Stress::kGain, 1, seed);
    const double gain = cv::mean(gained->frame)[0] / cv::mean(gained->reference)[0];
    EXPECT_TRUE(std::abs(gain - 0.7) < 0.02 || std::abs(gain - 1.4) < 0.02) << gain;
    const std::optional<StressPair> noisy = CutStressPair(ground, kCut, Stress::kNoise, 1, seed);
    cv::Mat difference;
    cv::subtract(noisy->frame, noisy->reference, difference, cv::noArray(), CV_32F);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(difference, mean, deviation);
    EXPECT_NEAR(deviation[0], 8 * std::sqrt(2.0), 0.3);
  }
}

TEST(StressPairs, RepeatFromTheirSeed) {
  const cv::Mat ground = Ground(1);
  const auto frame = [&](std::uint64_t seed) {
    return CutStressPair(ground, kCut, Stress::kCombined, 1, seed)->frame;
  };
  EXPECT_EQ(cv::norm(frame(3), frame(3), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(frame(3), frame(4), cv::NORM_INF), 0);
  EXPECT_NE(MixSeed(1, 2, 3), MixSeed(1, 3, 2));
  EXPECT_NE(MixSeed(1, 2, 3), MixSeed(2, 2, 3));
}

TEST(StressPairs, NeedRoom) {
  EXPECT_FALSE(CutStressPair(Ground(1), {600, 450}, Stress::kShift, 1, 1));
  EXPECT_TRUE(CutStressPair(Ground(1), {600, 450}, Stress::kGain, 1, 1));
}

TEST(FaultPairs, HaveTruthOnlyWhereThereIsSome) {
  const cv::Mat ground = Ground(1);
  const cv::Mat other = Ground(2);
  for (const Fault fault : kFaults) {
    const std::optional<StressPair> pair = CutFaultPair(ground, other, kCut, fault, 7);
    ASSERT_TRUE(pair) << NameOf(fault);
    EXPECT_EQ(pair->reference_from_frame.has_value(),
              fault == Fault::kBeyond || fault == Fault::kBlurred)
        << NameOf(fault);
  }
  EXPECT_LT(cv::mean(CutFaultPair(ground, other, kCut, Fault::kBlack, 7)->frame)[0], 3);
  const std::optional<StressPair> beyond = CutFaultPair(ground, other, kCut, Fault::kBeyond, 7);
  const double scale = std::sqrt(beyond->reference_from_frame->determinant());
  EXPECT_THAT(scale, testing::AllOf(testing::Gt(1 / 2.5), testing::Lt(1 / 1.6)));
}

TEST(MildPairs, RegisterUnderNoise) {
  const std::optional<StressPair> pair = CutMildPair(Ground(1), kCut, 5, 3);
  ASSERT_TRUE(pair);
  KltRegistration klt;
  klt.Register(pair->reference);
  EXPECT_LT(
      *PairRms(klt.Register(pair->frame), *pair->reference_from_frame, kCut.width, kCut.height),
      0.3);
}

}  // namespace
}  // namespace windhover::replay
