// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace windhover::replay {

// "label 120/240 (12.3 a second)" on stderr: in place on a terminal, otherwise a line every tenth
// of the way. Thread-safe.
class Progress {
 public:
  Progress(std::string label, int total);
  void Advance();
  // Ends the line on a terminal.
  void Finish();

 private:
  std::string label_;
  int total_;
  bool terminal_;
  int done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point shown_;
  std::mutex mutex_;
};

}  // namespace windhover::replay
