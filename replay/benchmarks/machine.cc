// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/machine.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

namespace windhover::replay {
namespace {

std::string ProcessorName() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

}  // namespace

MachineInfo ThisMachine() {
  const double bytes =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  constexpr double kBytesPerGib = 1024.0 * 1024 * 1024;
  return {.processor = ProcessorName(),
          .cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency())),
          .memory_gib = std::round(10 * bytes / kBytesPerGib) / 10};
}

}  // namespace windhover::replay
