// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/figures.h"
#include "replay/benchmarks/speed_benchmark.h"

namespace windhover::replay {

// Where the time of a frame goes, on the CPU twin and on an OpenCL device: registration, background
// and motion of anchor mode one after the other in one thread, the operators that they run, and for
// OpenCL the device's own times of kernels and transfers. Over the first flight of the settings at
// each size; rounds and centre mode are not asked for. Noting times costs some: rates are
// RunSpeedBenchmark's. Throws as that does.
BenchmarkDocument RunStageBenchmark(const SpeedBenchmarkSettings& settings,
                                    const BenchmarkProgress& progress);

}  // namespace windhover::replay
