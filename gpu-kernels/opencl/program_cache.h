// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace windhover::opencl {

// Compiled programs on disk, one file each. A cache can only save time: whatever is wrong with it
// (not writable, a damaged, truncated or foreign file) reads as "not there". Safe to share between
// threads and processes, as files appear whole or not at all.
class ProgramCache {
 public:
  // $XDG_CACHE_HOME/windhover, else ~/.cache/windhover; empty where neither variable is set.
  static std::filesystem::path DefaultFolder();

  // An empty folder keeps nothing.
  explicit ProgramCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // `key` is the full text of all that the binary depends on; it is stored beside the binary and
  // compared.
  std::optional<std::vector<unsigned char>> Load(const std::string& key) const;
  void Store(const std::string& key, const std::vector<unsigned char>& binary) const;

  std::filesystem::path FileOf(const std::string& key) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace windhover::opencl
