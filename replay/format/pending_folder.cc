// SPDX-License-Identifier: Apache-2.0
#include "replay/format/pending_folder.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "replay/format/format_error.h"
#include "replay/format/sequence.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPending = "pending";
constexpr const char* kOld = "old";  // what Commit has moved out of the way

// Neighbours' names up to the process's number.
std::string NeighbourName(const fs::path& path, const char* kind) {
  return "." + path.filename().string() + "." + kind + "-";
}

fs::path Neighbour(const fs::path& path, const char* kind) {
  return path.parent_path() / (NeighbourName(path, kind) + std::to_string(::getpid()));
}

// With links followed and without a trailing slash, so that there is a file name.
fs::path Named(const fs::path& path) {
  const fs::path normal = fs::weakly_canonical(fs::absolute(path));
  return normal.has_filename() ? normal : normal.parent_path();
}

bool IsDigits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// Throws FormatError unless the renderer has written the whole sequence.
void CheckRendered(const fs::path& path) {
  const auto refuse = [&path](const std::string& reason) {
    throw FormatError(path, "exists and is not replaced: " + reason);
  };
  if (!fs::exists(path / "seqinfo.ini")) refuse("it is no sequence");
  const SequenceInfo info = ReadSequenceInfo(path);
  if (info.rendered_by != kRenderer) {
    refuse(std::string("its seqinfo.ini does not say renderedBy=") + kRenderer);
  }
  const auto check = [&](const fs::path& folder, const auto& is_ours) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (is_ours(entry, entry.path().filename().string())) continue;
      refuse("it holds " + entry.path().lexically_relative(path).string() + ", which " + kRenderer +
             " did not write");
    }
  };
  check(path, [](const fs::directory_entry& entry, const std::string& name) {
    return name == "seqinfo.ini"
               ? fs::is_regular_file(entry.symlink_status())
               : (name == "img1" || name == "gt") && fs::is_directory(entry.symlink_status());
  });
  const auto plain = [](const fs::directory_entry& entry) {
    return fs::is_regular_file(entry.symlink_status());
  };
  check(path / "img1", [&](const fs::directory_entry& entry, const std::string&) {
    return plain(entry) && IsDigits(entry.path().stem().string()) &&
           entry.path().extension() == info.image_extension;
  });
  check(path / "gt", [&](const fs::directory_entry& entry, const std::string& name) {
    return plain(entry) && (name == "gt.txt" || name == "static.txt" || name == "homography.txt" ||
                            name == "horizon.txt");
  });
}

void CheckReplaceable(const fs::path& path) {
  if (!fs::exists(path)) return;
  if (!fs::is_directory(path)) throw FormatError(path, "exists and is no folder: not replaced");
  if (!fs::is_empty(path)) CheckRendered(path);
}

bool Lives(const std::string& process) {
  const long number = std::strtol(process.c_str(), nullptr, 10);
  return ::kill(static_cast<pid_t>(number), 0) == 0 || errno != ESRCH;
}

// What programs have left that were killed before they could remove it.
void RemoveStaleNeighbours(const fs::path& path) {
  if (!fs::is_directory(path.parent_path())) return;
  for (const char* kind : {kPending, kOld}) {
    const std::string start = NeighbourName(path, kind);
    std::vector<fs::path> stale;
    for (const fs::directory_entry& entry : fs::directory_iterator(path.parent_path())) {
      const std::string name = entry.path().filename().string();
      if (name.rfind(start, 0) != 0) continue;
      const std::string process = name.substr(start.size());
      if (IsDigits(process) && !Lives(process)) stale.push_back(entry.path());
    }
    for (const fs::path& one : stale) {
      // Killed between the two steps of Commit: what it moved away is still the latest.
      if (std::string_view(kind) == kOld && !fs::exists(path)) {
        fs::rename(one, path);
      } else {
        fs::remove_all(one);
      }
    }
  }
}

}  // namespace

PendingFolder::PendingFolder(std::filesystem::path final_path)
    : final_path_(Named(final_path)), path_(Neighbour(final_path_, kPending)) {
  RemoveStaleNeighbours(final_path_);
  CheckReplaceable(final_path_);
  fs::remove_all(path_);
  fs::create_directories(path_);
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void PendingFolder::Commit() {
  CheckReplaceable(final_path_);
  const fs::path old = Neighbour(final_path_, kOld);
  fs::remove_all(old);
  if (fs::exists(final_path_)) fs::rename(final_path_, old);
  fs::rename(path_, final_path_);
  fs::remove_all(old);
}

}  // namespace windhover::replay
