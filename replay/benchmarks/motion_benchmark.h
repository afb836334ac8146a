// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/figures.h"

namespace windhover::replay {

struct MotionBenchmarkSettings {
  std::filesystem::path dataset;  // FindSequences
  // Real sets, of which uavdt-s1301, uav123-person12 and uav123-building4-static take part.
  std::filesystem::path data;
  int frames = 0;      // first frames of each sequence and set that take part; 0: all
  std::string device;  // as Backend::Create takes it
};

// Motion detection with default options through its public interface, in anchor and in centre mode,
// and its peers, which are given the registration of anchor mode, in one run over every sequence;
// and on real video. Throws FormatError and DeviceError.
BenchmarkDocument RunMotionBenchmark(const MotionBenchmarkSettings& settings,
                                     const BenchmarkProgress& progress);

}  // namespace windhover::replay
