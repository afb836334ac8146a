// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/stage_benchmark.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>
#include <variant>

#include "replay/benchmarks/stage_log.h"
#include "tests/replay/benchmark_fixtures.h"

namespace windhover::replay {
namespace {

std::string Text(const TableCell& cell) { return std::get<std::string>(cell); }

// What is measured, not how long it takes.
TEST(StageBenchmark, NamesStepsOperatorsAndKernels) {
  SpeedBenchmarkSettings settings = {.sequences = {"1"}, .sizes = {{320, 240, 48}}};
  settings.centre_frames = 44;
  const BenchmarkDocument document = RunStageBenchmark(settings, kSilent);
  EXPECT_NO_THROW(JsonText(document));
  for (const std::string device : {"cpu", "opencl"}) {
    const auto table = Named(document.tables, "stages." + device + ".320x240");
    ASSERT_TRUE(table) << device << ": this test needs an OpenCL device";
    std::set<std::string> stages;
    double steps_ms = 0.0;
    double operators_ms = 0.0;
    for (const std::vector<TableCell>& row : table->rows) {
      ASSERT_EQ(row.size(), table->columns.size());
      const std::string level = Text(row[0]);
      const double median_ms = std::get<double>(row[3]);
      EXPECT_TRUE(stages.insert(level + ": " + Text(row[1])).second) << Text(row[1]);
      EXPECT_GT(std::get<double>(row[2]), 0.0) << Text(row[1]);
      EXPECT_LE(median_ms, std::get<double>(row[4])) << Text(row[1]);
      if (level == "service") steps_ms += median_ms;
      if (level == "operator") operators_ms += median_ms;
    }
    for (const char* stage : {"service: registration", "service: background", "service: motion",
                              "operator: temporal median", "operator: difference threshold"}) {
      EXPECT_TRUE(stages.contains(stage)) << device << ", " << stage;
    }
    EXPECT_GT(operators_ms, 0.0) << device;
    EXPECT_LT(operators_ms, 2.0 * steps_ms) << device << ": operators run inside of the steps";
    for (const char* stage : {"device: SampleTiles", "device: FindPeak", "device: TemporalMedian",
                              "device: DifferenceThreshold", "device: read", "device: map"}) {
      EXPECT_EQ(stages.contains(stage), device == "opencl") << stage;
    }
  }
}

TEST(StageBenchmark, RefusesWhatLeavesNothingToCount) {
  EXPECT_THROW(RunStageBenchmark({.sequences = {"1"}, .sizes = {{320, 240, 20}}}, kSilent),
               std::invalid_argument);
}

TEST(StageLog, AddsUpWithinAFrameAndCountsAbsenceAsNothing) {
  StageLog log;
  log.EndFrame();
  log.EndFrame();
  for (int frame = 0; frame < 3; ++frame) {
    log.Add(StageLog::Level::kDevice, "Kernel", 1.0);
    log.Add(StageLog::Level::kService, "step", 4.0);
    log.Add(StageLog::Level::kDevice, "Kernel", 2.0);
    log.EndFrame();
  }
  log.Add(StageLog::Level::kDevice, "Kernel", 100.0);  // of a frame that never ends
  const auto rows = log.Rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(Text(rows[0][0]), "service");
  EXPECT_EQ(Text(rows[1][1]), "Kernel");
  EXPECT_DOUBLE_EQ(std::get<double>(rows[0][2]), 0.6);
  EXPECT_DOUBLE_EQ(std::get<double>(rows[1][3]), 3.0);
  EXPECT_DOUBLE_EQ(std::get<double>(rows[1][4]), 3.0);

  StageLog seldom;
  for (int frame = 0; frame < 5; ++frame) {
    if (frame == 0) seldom.Add(StageLog::Level::kOperator, "once", 9.0);
    seldom.EndFrame();
  }
  EXPECT_DOUBLE_EQ(std::get<double>(seldom.Rows()[0][3]), 0.0);
}

}  // namespace
}  // namespace windhover::replay
