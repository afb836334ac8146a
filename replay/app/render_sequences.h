// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace windhover::replay {

struct RenderSettings {
  std::string sequences = "flight";  // FindFlightPlans
  std::filesystem::path out;         // of the one sequence, or of the folder of several
  int frames = 0;                    // at most; 0: all
  std::string size;                  // ParseSize; empty: as the flight has
  std::uint64_t seed = 0;            // 0: the flight's
  std::filesystem::path ground;      // a picture in place of the painted one, or empty
  int threads = 0;                   // 0: one a core
};

// Shows progress and calls `done` with the folder of each sequence that is complete. Throws
// std::invalid_argument, FormatError and Interrupted, and leaves nothing half-written.
void RenderSequences(const RenderSettings& settings,
                     const std::function<void(const std::filesystem::path&)>& done);

}  // namespace windhover::replay
