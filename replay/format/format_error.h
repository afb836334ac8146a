// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace windhover::replay {

// A dataset's file is missing or malformed. The text names the file, the line (from 1) where there
// is one, and the reason.
class FormatError : public std::runtime_error {
 public:
  FormatError(const std::filesystem::path& file, const std::string& reason)
      : std::runtime_error(file.string() + ": " + reason) {}
  FormatError(const std::filesystem::path& file, std::size_t line, const std::string& reason)
      : std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + reason) {}
};

}  // namespace windhover::replay
