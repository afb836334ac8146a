// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace windhover::replay {

// A folder that gets its final name only when it is complete, so that an interrupted program leaves
// no half sequence under that name. Until Commit its content lies in a hidden neighbour, which the
// destructor removes. What is there already is replaced only if it is a sequence or empty.
class PendingFolder {
 public:
  // Throws FormatError where `final_path` is something else than a sequence or an empty folder, and
  // std::filesystem::filesystem_error where the neighbour cannot be made.
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
