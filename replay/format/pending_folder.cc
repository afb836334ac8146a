// SPDX-License-Identifier: Apache-2.0
#include "replay/format/pending_folder.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

#include "replay/format/format_error.h"

namespace windhover::replay {
namespace {

std::filesystem::path Neighbour(const std::filesystem::path& path, const char* kind) {
  return path.parent_path() /
         ("." + path.filename().string() + "." + kind + "-" + std::to_string(::getpid()));
}

// Without a trailing slash, so that there is a file name.
std::filesystem::path Named(const std::filesystem::path& path) {
  const std::filesystem::path normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

void CheckReplaceable(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return;
  if (std::filesystem::is_directory(path) &&
      (std::filesystem::is_empty(path) || std::filesystem::exists(path / "seqinfo.ini"))) {
    return;
  }
  throw FormatError(path, "exists and is no sequence: not replaced");
}

}  // namespace

PendingFolder::PendingFolder(std::filesystem::path final_path)
    : final_path_(Named(final_path)), path_(Neighbour(final_path_, "pending")) {
  CheckReplaceable(final_path_);
  std::filesystem::remove_all(path_);
  std::filesystem::create_directories(path_);
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void PendingFolder::Commit() {
  CheckReplaceable(final_path_);
  const std::filesystem::path old = Neighbour(final_path_, "old");
  std::filesystem::remove_all(old);
  if (std::filesystem::exists(final_path_)) std::filesystem::rename(final_path_, old);
  std::filesystem::rename(path_, final_path_);
  std::filesystem::remove_all(old);
}

}  // namespace windhover::replay
