// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/phase_correlation/phase_correlation.h"

namespace windhover {

// Runs on the host, with FFTW3's transforms. Throws std::invalid_argument where settings are out of
// range.
std::unique_ptr<PhaseCorrelation> MakePhaseCorrelationCpu(const PhaseCorrelationSettings& settings);

}  // namespace windhover
