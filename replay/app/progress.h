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
  explicit Progress(std::string label, int total = 0);
  // By one.
  void Advance();
  // To `done` of what may be known to be so many by now.
  void AdvanceTo(int done, int total);
  // Ends the line on a terminal.
  void Finish();

 private:
  void ShowAdvance(int done);
  // Whether a step that is worth a line has been completed on the way to `done`.
  bool Passes(int done) const;

  std::string label_;
  int total_;
  bool terminal_;
  int done_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point shown_;
  std::mutex mutex_;
};

}  // namespace windhover::replay
