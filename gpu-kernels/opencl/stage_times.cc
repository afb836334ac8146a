// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/stage_times.h"

namespace windhover::opencl {

cl_event* StageTimes::Next(const std::string& stage) {
  if (!observe_) return nullptr;
  return stages_.emplace_back(stage, Handle<cl_event>()).second.out();
}

void StageTimes::Add(const std::string& stage, Handle<cl_event> event) {
  if (observe_) stages_.emplace_back(stage, std::move(event));
}

void StageTimes::Report() {
  for (const auto& [stage, event] : stages_) {
    cl_ulong start_ns = 0;
    cl_ulong end_ns = 0;
    if (event.get() == nullptr ||
        clGetEventProfilingInfo(event.get(), CL_PROFILING_COMMAND_START, sizeof(start_ns),
                                &start_ns, nullptr) != CL_SUCCESS ||
        clGetEventProfilingInfo(event.get(), CL_PROFILING_COMMAND_END, sizeof(end_ns), &end_ns,
                                nullptr) != CL_SUCCESS ||
        end_ns < start_ns) {
      continue;
    }
    observe_(stage, 1e-6 * static_cast<double>(end_ns - start_ns));
  }
  stages_.clear();
}

}  // namespace windhover::opencl
