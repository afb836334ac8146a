// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace windhover::replay {

// A sequence's folder that gets its final name only when it is complete, so that an interrupted
// program leaves no half sequence under that name. Until Commit its content lies in a hidden
// neighbour, ".NAME.pending-PID", which the destructor removes; where a program was killed, the
// next one for the same name does. What is there already is replaced only if it is an empty folder
// or a sequence that this program has rendered and nothing else has been put into.
class PendingFolder {
 public:
  // Throws FormatError where `final_path` is anything else, and std::filesystem::filesystem_error
  // where the neighbour cannot be made.
  explicit PendingFolder(std::filesystem::path final_path);
  ~PendingFolder();
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  // Where to write.
  const std::filesystem::path& path() const { return path_; }
  // Puts the folder in place of what bears the final name now.
  void Commit();

 private:
  std::filesystem::path final_path_;
  std::filesystem::path path_;
};

}  // namespace windhover::replay
