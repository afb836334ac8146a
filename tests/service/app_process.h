// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace windhover {

// A program under test as a process of its own, with its standard output in a pipe. Every wait ends
// after a minute.
class Process {
 public:
  // `environment` replaces or adds variables, as "NAME=value"; CYCLONEDDS_URI is unset otherwise.
  explicit Process(const std::vector<std::string>& command,
                   const std::vector<std::string>& environment = {});
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  // The next line of the output without its line feed; nothing at its end.
  std::optional<std::string> ReadLine();
  // All lines up to the end of the output.
  std::vector<std::string> ReadLines();
  // Reads no more: the program writes into a closed pipe from now on.
  void CloseOutput();
  void Signal(int number) const;
  // The exit code, 128 + number where a signal ended it, -1 where it does not end.
  int Wait();
  // What it has written to the standard error up to now.
  std::string ErrorText() const;

 private:
  pid_t pid_ = 0;
  int output_ = -1;
  std::FILE* errors_ = nullptr;
  std::string unread_;
};

// What a program that runs to its end has said.
struct Outcome {
  int exit_code = -1;
  std::vector<std::string> lines;
  std::string errors;
};
Outcome RunToEnd(const std::vector<std::string>& command,
                 const std::vector<std::string>& environment = {});

// An empty folder that goes with the object.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  // Names of what lies in it.
  std::vector<std::string> Names() const;

 private:
  std::filesystem::path path_;
};

}  // namespace windhover
