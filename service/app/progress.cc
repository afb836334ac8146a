// SPDX-License-Identifier: Apache-2.0
#include "service/app/progress.h"

#include <unistd.h>

#include <cstdio>

namespace windhover {
namespace {

constexpr auto kOnTerminal = std::chrono::milliseconds(200);
constexpr auto kElsewhere = std::chrono::seconds(5);
// Back to the first column, and everything behind it goes.
constexpr const char* kEraseLine = "\r\x1b[K";

}  // namespace

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now()) {
  next_ += terminal_ ? Clock::duration(kOnTerminal) : Clock::duration(kElsewhere);
}

void Progress::Show(const std::string& text, Clock::time_point now) {
  if (now < next_) return;
  next_ = now + (terminal_ ? Clock::duration(kOnTerminal) : Clock::duration(kElsewhere));
  if (terminal_) {
    std::fprintf(stderr, "%s%s", kEraseLine, text.c_str());
    shown_ = true;
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  std::fflush(stderr);
}

void Progress::Clear() {
  if (!shown_) return;
  std::fputs(kEraseLine, stderr);
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace windhover
