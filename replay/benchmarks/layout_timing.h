// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/registration_results.h"

namespace windhover::replay {

// Times one frame's registration by layout of tiles on sequences a1 to a4, as far as they are
// there, on the CPU twin and on an OpenCL device: `backend`'s or the best one (thesis 2.4.4,
// figure 2.7). All layouts and devices take turns frame by frame. Names in `left_out` what is
// absent.
void TimeLayouts(const std::shared_ptr<Backend>& backend,
                 const std::vector<DatasetSequence>& sequences, const BenchmarkProgress& progress,
                 RegistrationResults& results, std::vector<std::string>& left_out);

}  // namespace windhover::replay
