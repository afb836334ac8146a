// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/motion_results.h"
#include "tests/replay/benchmark_fixtures.h"

namespace windhover::replay {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

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
  results.real = {{"set", 4, 6, false, {0.5, 0.25, 0}}, {"still", 4, 2, true, {}}};
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
  EXPECT_THAT(ValueOf(figures, "motion.real.still.false_alarms_per_frame"), Optional(0.5));
  EXPECT_FALSE(ValueOf(figures, "motion.real.still.boxes_per_frame"));
  EXPECT_FALSE(ValueOf(figures, "motion.real.still.recall_005"));
  EXPECT_FALSE(ValueOf(figures, "motion.s1.f1_005"));
  EXPECT_FALSE(ValueOf(MotionFigures(HandMadeMotion(9)), "motion.precision.mean"));
  EXPECT_FALSE(ValueOf(MotionFigures(HandMadeMotion(9)), "motion.centre_minus_anchor"));
}

TEST(MotionResults, SayWhichRatiosHaveNothingToDivideBy) {
  EXPECT_THAT(UndefinedRatios(HandMadeMotion(10)),
              ElementsAre("motion.frame_differencing.precision.01: nothing was detected"));
}

TEST(MotionResults, TableEndsWithTheMeanOfTheTen) {
  const auto table = Named(MotionTables(HandMadeMotion(10)), "motion.table_6_1");
  ASSERT_TRUE(table);
  ASSERT_EQ(table->rows.size(), 11);
  const std::vector<TableCell>& mean = table->rows.back();
  ASSERT_EQ(mean.size(), 11);
  EXPECT_NEAR(std::get<double>(mean[1]), 64.0, 1e-9);  // thesis, frame differencing
  EXPECT_NEAR(std::get<double>(mean[4]), 62.4, 1e-9);
  EXPECT_NEAR(std::get<double>(mean[5]), 100, 1e-9);
  EXPECT_NEAR(std::get<double>(mean[10]), 45, 1e-9);
  EXPECT_EQ(Named(MotionTables(HandMadeMotion(9)), "motion.table_6_1")->rows.size(), 9);
}

TEST(MotionResults, ArePlottedBySequence) {
  MotionResults results = HandMadeMotion(2);
  results.curves["02"] = {{40, 1, {10, 20, 5}}, {40, 2, {10, 10, 5}}, {20, 1, {10, 0, 0}}};
  const auto plot = Named(MotionPlots(results), "motion.figure_6_7");
  ASSERT_TRUE(plot);
  ASSERT_EQ(plot->panels.size(), 2);
  const std::vector<PlotSeries>& series = plot->panels[1].series;
  std::vector<std::string> names;
  for (const PlotSeries& one : series) names.push_back(one.name);
  EXPECT_THAT(names, ElementsAre("FD, threshold 40", "FD, threshold 20", "windhover", "centre",
                                 "FD", "thesis", "thesis FD"));
  ASSERT_EQ(series[0].points.size(), 2);
  EXPECT_TRUE(series[0].line);
  EXPECT_EQ(series[0].points[1].x, 50);      // recall
  EXPECT_EQ(series[0].points[1].y, 50);      // precision
  EXPECT_THAT(series[1].points, IsEmpty());  // no detection: no precision
  EXPECT_EQ(series[5].points.at(0).x, 54.9);
  const auto overlaps = Named(MotionPlots(results), "motion.f1");
  ASSERT_TRUE(overlaps);
  EXPECT_EQ(overlaps->panels.at(0).series.at(0).points.size(), 3);
}

TEST(MotionResults, TableOfTheCurveHasOneColumnPairAThreshold) {
  MotionResults results = HandMadeMotion(4);
  results.curves["04"] = {
      {40, 1, {10, 20, 5}}, {40, 2, {10, 10, 5}}, {20, 1, {10, 50, 10}}, {20, 2, {10, 10, 10}}};
  const auto table = Named(MotionTables(results), "motion.figure_6_7");
  ASSERT_TRUE(table);
  EXPECT_THAT(table->columns, ElementsAre("least area px", "P at 40", "R", "P at 20", "R"));
  using Row = std::vector<TableCell>;
  EXPECT_THAT(table->rows,
              ElementsAre(Row{1, 25.0, 50.0, 20.0, 100.0}, Row{2, 50.0, 50.0, 100.0, 100.0}));
}

}  // namespace
}  // namespace windhover::replay
