// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace windhover::replay {

struct MachineInfo {
  std::string processor;  // the model's name as the system gives it, or "unknown"
  int cores = 1;
  double memory_gib = 0;  // physical, rounded to a tenth
};

MachineInfo ThisMachine();

}  // namespace windhover::replay
