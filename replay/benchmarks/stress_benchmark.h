// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/registration_results.h"

namespace windhover::replay {

struct StressBenchmarkSettings {
  std::shared_ptr<Backend> backend;
  std::vector<DatasetSequence> sequences;
  std::filesystem::path data;  // where aerial-stills-brighton may lie
  int frames = 0;              // of each sequence that pictures are taken from; 0: all
  int pictures = 10;           // of each sequence, evenly spread
  int slow_every = 10;         // pairs, of which slow peers take part in one
};

// Pairs cut from the dataset's and the stills' pictures (stress_pairs.h), registered each by
// itself: fills in how many register under each stress, for all contestants; and for the product
// whether it flagged what failed, and how its covariance compares with its errors under noise of 2,
// 5 and 10 grey levels. `results.contestants` are the product and then RegistrationPeerKinds, in
// order. Names in `left_out` what is absent.
void RunStressBenchmark(const StressBenchmarkSettings& settings, const BenchmarkProgress& progress,
                        RegistrationResults& results, std::vector<std::string>& left_out);

}  // namespace windhover::replay
