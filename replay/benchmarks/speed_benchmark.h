// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "replay/benchmarks/figures.h"
#include "replay/render/flight_plan.h"

namespace windhover::replay {

struct SpeedBenchmarkSettings {
  FlightPlan plan;          // what is played; each frame once a round
  int rounds = 3;           // in each of which every contestant runs once
  int centre_frames = 120;  // at most, through the pipeline in centre mode, which is slow
  int threads = 1;          // for rendering
};

struct SpeedContestant {
  std::string name;      // "registration anchor, CPU twin"
  double fps = 0;        // mean rate of a round, of the median round
  double median_ms = 0;  // a frame, over all rounds
  double p95_ms = 0;
  double rms_px = 0;  // mean over consecutive frames; registration only
  int frames = 0;     // that were measured
};

struct SpeedBenchmarkResult {
  std::vector<SpeedContestant> contestants;
  std::vector<Figure> figures;
  std::string opencl_device;  // empty where there is none: its figures are absent
  // That the program takes when nobody asks for another, WINDHOVER_DEVICE included.
  std::string default_device;
  std::string plugin_file;  // the elements that were measured
};

// Registration alone and the whole pipeline (whregister ! whbackground ! whmotion), on the CPU twin
// and on an OpenCL device (that taken by default or else the best one), in anchor and in centre
// mode, against KLT. A pipeline's rate is that at which frames leave it while others still come in,
// with as many on the way at the start of the count as at its end. All take part in turns in each
// round, so that whatever else the machine does meets all of them. Frames are rendered and decoded
// before; each round's first frames (compilation, filling windows) are not counted. `say` takes a
// line of progress.
SpeedBenchmarkResult RunSpeedBenchmark(const SpeedBenchmarkSettings& settings,
                                       const std::function<void(const std::string&)>& say);

}  // namespace windhover::replay
