// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>
#include <utility>

#include "service/app/random_name.h"

namespace windhover {

// A result that takes its name only when it is complete; until then, and for good where it never
// is, nothing of it lies under that name. It is written under a name of its own, so several may be
// on the way to one name; the last to be complete stays.
class PendingFile {
 public:
  explicit PendingFile(std::filesystem::path path)
      : path_(std::move(path)), temporary_(path_.string() + "." + RandomName() + ".part") {}
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
  }

  // Where to write.
  const std::filesystem::path& temporary() const { return temporary_; }

  // Gives the file its name. Throws std::filesystem::filesystem_error.
  void Complete() { std::filesystem::rename(temporary_, path_); }

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
};

}  // namespace windhover
