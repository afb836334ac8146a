// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "replay/benchmarks/layout_timing.h"
#include "replay/benchmarks/registration_results.h"
#include "replay/benchmarks/thesis_results.h"
#include "replay/format/sequence.h"
#include "tests/replay/benchmark_fixtures.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Optional;
using testing::Pair;

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

// Wrong by 1 px for each px below the middle: all of the error is in the lower half.
TEST(PairRms, CountsWhatLiesBelowTheHorizonOnly) {
  Eigen::Matrix3d stretched = Eigen::Matrix3d::Identity();
  stretched(0, 1) = 1;
  stretched(0, 2) = -240;
  const auto rms = [&](const GroundSeen& ground) {
    return *PairRms(stretched, Shift(0, 0), 640, 480, ground);
  };
  const Eigen::Vector3d lowest(0, 1, -470);
  EXPECT_NEAR(rms({}), 240 / std::sqrt(3.0), 2);
  EXPECT_NEAR(rms({lowest, lowest}), 235, 5);
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
    results.layouts["36"][id] = {{0.25}, {}};
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
  EXPECT_THAT(tables[0].columns, ElementsAre("sequence", "of", "4", "5", "8", "9", "16", "25",
                                             "25+", "36", "64", "100", "225", "400", "625"));
  ASSERT_EQ(tables[0].rows.size(), 4);
  const auto cells = [&](int row) {
    const std::vector<TableCell>& all = tables[0].rows[row];
    return std::vector<TableCell>{all[0], all[1], all[2], all[9], all[14]};
  };
  using Row = std::vector<TableCell>;
  EXPECT_EQ(cells(0), (Row{"01", "windhover", {}, 0.25, {}}));
  EXPECT_EQ(cells(1), (Row{"01", "thesis", 0.66, 0.33, 0.38}));
  EXPECT_EQ(cells(2), (Row{"02", "windhover", {}, 0.25, {}}));
  EXPECT_EQ(cells(3), (Row{"02", "thesis", 1.08, 0.40, 0.69}));
  for (const FigureTable& table : tables) EXPECT_NE(table.name, "registration.table_2_3");
}

TEST(RegistrationResults, ShowWindowsOnlyWhereA4WasMeasured) {
  RegistrationResults results = HandMade(1);
  results.windows["Blackman, alpha 0.16"] = {{0.25, 0.75}, {}};
  const auto table = Named(RegistrationTables(results), "registration.table_2_3");
  ASSERT_TRUE(table);
  using Row = std::vector<TableCell>;
  ASSERT_EQ(table->rows.size(), 8);
  EXPECT_EQ(table->rows[0], (Row{"none", {}, 0.358}));
  EXPECT_EQ(table->rows[2], (Row{"Blackman, alpha 0.16", 0.5, 0.23}));
}

TEST(RegistrationResults, SayWhetherEachWindowBeatsNone) {
  RegistrationResults results = HandMade(1);
  const auto title = [&results] {
    return Named(RegistrationTables(results), "registration.table_2_3")->title;
  };
  const auto worse = [&results] {
    return ValueOf(RegistrationFigures(results), "registration.windows_no_better_than_none");
  };
  EXPECT_EQ(worse(), std::nullopt);
  results.windows["none"] = {{0.5, 0.7}, {}};
  EXPECT_EQ(worse(), std::nullopt);
  EXPECT_THAT(title(), Not(HasSubstr("none")));
  for (const ThesisWindow& window : kThesisWindows) {
    if (window.window != WindowKind::kNone) results.windows[window.name] = {{0.9, 0.2}, {}};
  }
  EXPECT_THAT(worse(), Optional(0));
  EXPECT_THAT(title(), HasSubstr("each beats none, as in the thesis"));
  results.windows["cosine"] = {{0.6, 0.6}, {}};
  results.windows["Tukey, alpha 0.6"] = {{0.6, 0.7}, {}};
  EXPECT_THAT(worse(), Optional(2));
  EXPECT_THAT(title(), HasSubstr("unlike in the thesis: cosine; Tukey, alpha 0.6"));
}

TEST(RegistrationResults, ShowTimesByLayout) {
  RegistrationResults results = HandMade(1);
  EXPECT_FALSE(Named(RegistrationPlots(results), "registration.figure_2_7"));
  results.layout_times_ms = {{"CPU twin", {{"36", {3, 1, 2}}, {"8", {5}}}},
                             {"OpenCL", {{"36", {0.5}}}}};
  const auto table = Named(RegistrationTables(results), "registration.figure_2_7");
  ASSERT_TRUE(table);
  EXPECT_THAT(table->columns,
              ElementsAre("tiles", "CPU twin median", "p95", "OpenCL median", "p95"));
  using Row = std::vector<TableCell>;
  EXPECT_THAT(table->rows, Contains(Row{"36", 2.0, 3.0, 0.5, 0.5}));
  EXPECT_THAT(table->rows, Contains(Row{"8", 5.0, 5.0, {}, {}}));
  const auto plot = Named(RegistrationPlots(results), "registration.figure_2_7");
  ASSERT_TRUE(plot);
  EXPECT_THAT(plot->x.categories, ElementsAre("4", "5", "8", "9", "16", "25", "25+", "36", "64",
                                              "100", "225", "400", "625"));
  const PlotSeries& twin = plot->panels.at(0).series.at(0);
  ASSERT_EQ(twin.points.size(), 2);
  EXPECT_EQ(twin.points[1].x, 7);
  EXPECT_EQ(twin.points[1].y, 2);
  EXPECT_EQ(twin.points[1].y_high, 3);
}

TEST(RegistrationResults, ArePlottedBySequence) {
  const auto plot = Named(RegistrationPlots(HandMade(2)), "registration.rms_by_sequence");
  ASSERT_TRUE(plot);
  EXPECT_TRUE(plot->y.log);
  EXPECT_THAT(plot->x.categories, ElementsAre("01", "02"));
  std::map<std::string, double> second;
  for (const PlotSeries& series : plot->panels.at(0).series) {
    second[series.name] = series.points.at(1).y;
  }
  EXPECT_THAT(second, ElementsAre(Pair("KLT", 2), Pair("thesis", 0.40), Pair("windhover", 0.2)));
}

TEST(LayoutTiming, TimesEveryLayoutOnWhatIsThere) {
  const ScratchFolder folder;
  SequenceInfo info;
  info.frames = 14;
  info.width = 640;
  info.height = 480;
  std::filesystem::create_directories(folder / "a1/img1");
  WriteSequenceInfo(folder / "a1", info);
  for (int i = 1; i <= info.frames; ++i) {
    cv::imwrite(FramePath(folder / "a1", info, i).string(), Ground(i));
  }
  RegistrationResults results;
  std::vector<std::string> left_out;
  TimeLayouts(Backend::Create("cpu"), {{"01", folder / "01"}, {"a1", folder / "a1"}}, kSilent,
              results, left_out);
  ASSERT_TRUE(results.layout_times_ms.count("CPU twin"));
  for (const auto& [device, times] : results.layout_times_ms) {
    EXPECT_EQ(times.size(), 13) << device;
    for (const auto& [layout, samples] : times) EXPECT_EQ(samples.size(), 10) << layout;
  }
  EXPECT_THAT(left_out,
              AllOf(Contains(HasSubstr("no a2")), Contains(HasSubstr("no a4")),
                    Contains(HasSubstr("without padding")), Not(Contains(HasSubstr("no a1")))));
}

}  // namespace
}  // namespace windhover::replay
