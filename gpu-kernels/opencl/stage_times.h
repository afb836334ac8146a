// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/opencl/api.h"

namespace windhover::opencl {

// The device's own times of what was enqueued on one queue, for an observer. Without one it does
// nothing, and the queue needs no profiling.
class StageTimes {
 public:
  explicit StageTimes(StageObserver observe) : observe_(std::move(observe)) {}

  // Where the next call shall put its event, which this then owns; null where nobody observes.
  cl_event* Next(const std::string& stage);

  void Add(const std::string& stage, Handle<cl_event> event);

  // Tells the times of all since the last report. They must have ended; those that failed are left
  // out.
  void Report();

 private:
  StageObserver observe_;
  std::vector<std::pair<std::string, Handle<cl_event>>> stages_;
};

}  // namespace windhover::opencl
