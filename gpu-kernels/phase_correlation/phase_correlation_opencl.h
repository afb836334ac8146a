// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"

namespace windhover {

// How the kernels are laid out on a device. Changes the speed, not the result.
struct PhaseCorrelationLayout {
  // Columns that one work-item transforms at a time, one a vector lane: 1, 2, 4, 8 or 16.
  int lanes = 1;
  // Rows of a tile that one work-item samples: 1, 2, 4, 8 or 16.
  int sample_rows = 1;
  // Samples that it works on together, a power of two; at least `lanes` are.
  int sample_batch = 1;
  // Work-items in a group of those that sample and transform: a power of two. Fewer where a row of
  // groups has fewer.
  int work_group = 32;
  // Work-items that look for the peak of one tile together: a power of two, 1 to 256.
  int peak_group = 64;

  // CPUs want few work-items with much to do, of the vector width they have; GPUs the opposite.
  static PhaseCorrelationLayout For(const opencl::Context& context);
};

// Runs on the context's device. Throws DeviceError, and std::invalid_argument where settings are
// out of range.
std::unique_ptr<PhaseCorrelation> MakePhaseCorrelationOpenCl(
    opencl::Context& context, const PhaseCorrelationSettings& settings,
    const PhaseCorrelationLayout& layout);

}  // namespace windhover
