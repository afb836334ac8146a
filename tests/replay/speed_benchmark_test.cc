// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/speed_benchmark.h"

#include <gmock/gmock.h>

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

// What is measured, not how fast it is: that is for people to run on a machine that does nothing
// else.

namespace windhover::replay {
namespace {

const BenchmarkProgress kSilent = {[](const std::string&) {}, [] {}};

SpeedBenchmarkSettings Small() {
  return {.sequences = {"1"},
          .sizes = {{320, 240, 48}, {240, 180, 44}},
          .centre_frames = 44,
          .rounds = 2,
          .threads = 2};
}

TEST(SpeedBenchmark, EveryRunHasARateAndWhatItWasWorth) {
  const BenchmarkDocument document = RunSpeedBenchmark(Small(), kSilent);
  std::map<std::string, double> figures;
  for (const Figure& figure : document.figures) {
    EXPECT_TRUE(figures.emplace(figure.name, figure.value).second) << figure.name;
  }
  for (const std::string size : {"320x240", "240x180"}) {
    for (const char* fps :
         {"registration.fps.cpu.", "pipeline.fps.", "pipeline.fps.cpu.", "peer.klt.fps."}) {
      ASSERT_TRUE(figures.contains(fps + size)) << fps + size;
      EXPECT_GT(figures[fps + size], 0) << fps + size;
    }
    // The flight is followed, by the same frames that are timed.
    for (const char* rms : {"speed.registration.cpu.rms_px.", "speed.pipeline.cpu.rms_px.",
                            "speed.peer.klt.rms_px."}) {
      ASSERT_TRUE(figures.contains(rms + size)) << rms + size;
      EXPECT_LT(figures[rms + size], 0.5) << rms + size;
    }
    EXPECT_TRUE(figures.contains("speed.pipeline.f1_005." + size));
    EXPECT_FALSE(figures.contains("speed.registration.cpu.f1_005." + size));
  }
  EXPECT_GT(figures["speed.pipeline.f1_005.320x240"], 0.2);
  EXPECT_GT(figures["speed.pipeline.centre.f1_005.320x240"], 0.2);
  // Only at the first size.
  EXPECT_GT(figures["pipeline.fps.centre.320x240"], 0);
  EXPECT_FALSE(figures.contains("pipeline.fps.centre.240x180"));
  EXPECT_GT(figures["pipeline.p50_ms.320x240"], 0);
  EXPECT_GE(figures["pipeline.p99_ms.320x240"], figures["pipeline.p50_ms.320x240"]);
  EXPECT_FALSE(figures.contains("pipeline.p50_ms.240x180"));
  EXPECT_GT(figures["registration.speed_ratio_to_klt"], 0);
  ASSERT_EQ(document.tables.size(), 2U);
  EXPECT_EQ(document.tables[1].name, "speed.240x180");
  EXPECT_NO_THROW(JsonText(document));
}

TEST(SpeedBenchmark, RefusesWhatLeavesNothingToCount) {
  SpeedBenchmarkSettings short_one = Small();
  short_one.sizes[1].frames = 41;
  EXPECT_THROW(RunSpeedBenchmark(short_one, kSilent), std::invalid_argument);
  SpeedBenchmarkSettings short_centre = Small();
  short_centre.centre_frames = 41;
  EXPECT_THROW(RunSpeedBenchmark(short_centre, kSilent), std::invalid_argument);
  SpeedBenchmarkSettings odd = Small();
  odd.sizes[0].width = 321;
  EXPECT_THROW(RunSpeedBenchmark(odd, kSilent), std::invalid_argument);
}

}  // namespace
}  // namespace windhover::replay
