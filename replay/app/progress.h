// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace windhover::replay {

// "label 120/240 (12.3 a second)" on stderr: in place on a terminal, otherwise a line every tenth
// of the way. Without a total "label 120 (12.3 a second)", and a line every hundred. Thread-safe.
class Progress {
 public:
  // `total` 0: not known.
  Progress(std::string label, int total);
  void Advance();
  // Ends the line on a terminal.
  void Finish();

 private:
  // Whether one more has completed a step that is worth a line.
  bool Passed() const;

  std::string label_;
  int total_;
  bool terminal_;
  int done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point shown_;
  std::mutex mutex_;
};

}  // namespace windhover::replay
