// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/figures.h"

namespace windhover::replay {

struct RegistrationBenchmarkSettings {
  std::filesystem::path dataset;  // FindSequences
  std::filesystem::path data;     // real sets; aerial-stills-brighton of them, where it is there
  // First frames of each sequence that take part; 0: all.
  int frames = 0;
  // Pictures of each sequence that pairs under stress are cut from.
  int stress_pictures = 10;
  std::string device;  // as Backend::Create takes it
  // windhover-replay, to time its first frame; empty: not timed.
  std::filesystem::path program;
};

// Registration with default options through its public interface, and its peers, in one run: on
// consecutive frames and on frames ten apart of every sequence, by number of tiles, under stress
// and faults. The contestants take turns frame by frame. Slow peers take part in every tenth pair.
// Throws FormatError and DeviceError.
BenchmarkDocument RunRegistrationBenchmark(const RegistrationBenchmarkSettings& settings,
                                           const BenchmarkProgress& progress);

}  // namespace windhover::replay
