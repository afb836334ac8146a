// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "replay/benchmarks/speed_benchmark.h"
#include "replay/benchmarks/speed_contestants.h"

namespace windhover::replay {

// "640x480".
std::string SizeText(const SpeedSize& size);

// Throws std::invalid_argument where nothing would be left to count, and for odd sizes.
void Check(const SpeedBenchmarkSettings& settings);

// The start of a flight, rendered at that size.
SpeedFlight RenderSpeedFlight(const std::string& sequence, const SpeedSize& size, int threads,
                              const BenchmarkProgress& progress);

struct SpeedDevice {
  std::string name;  // in figures: "cpu" or "opencl"
  std::string selector;
};

// The CPU twin and an OpenCL device: that taken by default or else the best one.
struct SpeedDevices {
  std::vector<SpeedDevice> devices;  // the default one first
  std::string by_default;            // for people
  std::string opencl;                // the same, "none" where there is none
  std::vector<std::string> left_out;
};
SpeedDevices DevicesToTime();

}  // namespace windhover::replay
