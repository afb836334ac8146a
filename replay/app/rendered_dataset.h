// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

namespace windhover::replay {

struct RemoveFolder {
  void operator()(const std::filesystem::path* folder) const;
};
using TemporaryFolder = std::unique_ptr<const std::filesystem::path, RemoveFolder>;

// The ten sequences, a1 to a4 and s1, at most `frames` of each (0: all), in a folder that goes with
// the pointer. Shows progress; throws as RenderSequences does.
TemporaryFolder RenderDataset(int frames);

}  // namespace windhover::replay
