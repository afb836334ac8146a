// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "replay/benchmarks/registration_results.h"

namespace windhover::replay {

// Registers the first two frames of a sequence: what a program does until its first homography.
// Throws FormatError and DeviceError.
void RegisterFirstPair(const std::filesystem::path& sequence, const std::string& device);

// Runs `program bench first-frame SEQUENCE`, which is to call RegisterFirstPair, once with empty
// caches of its own for compiled programs and several times with what that has left. Seconds from
// the start of the process to its end: that of the first run and the median of the others. On the
// CPU twin, which compiles nothing, both are about the same. Throws std::runtime_error where the
// program fails.
FirstFrameSeconds TimeFirstFrame(const std::filesystem::path& program,
                                 const std::filesystem::path& sequence);

}  // namespace windhover::replay
