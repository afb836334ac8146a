// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/figures.h"

namespace windhover::replay {

struct SpeedSize {
  int width = 0;  // px, even
  int height = 0;
  int frames = 0;  // of each flight, from its start
};

// As the full benchmark has it.
struct SpeedBenchmarkSettings {
  std::vector<std::string> sequences = {"1", "3"};  // FindFlightPlan
  // At the first one centre mode and latency are measured, too.
  std::vector<SpeedSize> sizes = {{640, 480, 110}, {1280, 720, 58}, {1920, 1080, 50}};
  int centre_frames = 80;  // of each flight that centre mode, which is slow, gets at most
  int rounds = 3;          // in each of which every contestant runs once over each flight
  int threads = 1;         // for rendering
};

// One flight and fewer frames, for a quick look.
SpeedBenchmarkSettings QuickSpeedBenchmark();

// Registration alone and the whole pipeline (whregister ! whbackground ! whmotion), on the CPU twin
// and on an OpenCL device (that taken by default or else the best one), against KLT. Each flight is
// rendered into memory once, so no pair of frames comes twice in a run. All take part in turns in
// each round, so that whatever else the machine does meets all of them. A pipeline's rate is that
// at which frames leave it while others still come in, with as many on the way at the start of the
// count as at its end. Every run is also held against the flight's truth. README.md beside this
// file says what each figure is. Throws std::invalid_argument where there are too few frames.
BenchmarkDocument RunSpeedBenchmark(const SpeedBenchmarkSettings& settings,
                                    const BenchmarkProgress& progress);

}  // namespace windhover::replay
