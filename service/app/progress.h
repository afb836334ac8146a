// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace windhover {

// Shows how far a job is on the standard error: on a terminal one line that is written again and
// again, elsewhere a line now and then.
class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  Progress();
  ~Progress() { Clear(); }

  // Shows the text when it is time for it.
  void Show(const std::string& text, Clock::time_point now);
  // Takes the line off the terminal, before other output.
  void Clear();

 private:
  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;
};

}  // namespace windhover
