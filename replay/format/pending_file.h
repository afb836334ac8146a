// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <utility>

#include "replay/format/format_error.h"

namespace windhover::replay {

// A file that takes its name only when it is complete; until then, and for good where it never is,
// nothing of it lies under that name.
class PendingFile {
 public:
  explicit PendingFile(std::filesystem::path path)
      : path_(std::move(path)), temporary_(path_.string() + ".pending") {}
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
  }

  // Where to write.
  const std::filesystem::path& temporary() const { return temporary_; }

  // Gives the file its name. Throws FormatError.
  void Complete() {
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    if (error) throw FormatError(path_, "cannot be written");
  }

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
};

}  // namespace windhover::replay
