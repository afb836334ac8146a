// SPDX-License-Identifier: Apache-2.0
#include "replay/app/progress.h"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <utility>

namespace windhover::replay {

Progress::Progress(std::string label, int total)
    : label_(std::move(label)),
      total_(total),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

void Progress::Advance() {
  const std::scoped_lock lock(mutex_);
  ShowAdvance(done_ + 1);
}

void Progress::AdvanceTo(int done, int total) {
  const std::scoped_lock lock(mutex_);
  total_ = total;
  if (done > done_) ShowAdvance(done);
}

void Progress::ShowAdvance(int done) {
  const auto now = std::chrono::steady_clock::now();
  const bool due = terminal_ ? now - shown_ > std::chrono::milliseconds(100) : Passes(done);
  done_ = done;
  if (!due && done_ != total_) return;
  shown_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const std::string total = total_ > 0 ? "/" + std::to_string(total_) : "";
  std::fprintf(stderr, "%s%s %d%s (%.1f a second)%s", terminal_ ? "\r" : "", label_.c_str(), done_,
               total.c_str(), seconds > 0 ? done_ / seconds : 0.0, terminal_ ? "\x1b[K" : "\n");
}

bool Progress::Passes(int done) const {
  const std::int64_t parts = total_ > 0 ? 10 : 1;
  const std::int64_t whole = total_ > 0 ? total_ : 100;
  return parts * done / whole != parts * done_ / whole;
}

void Progress::Finish() {
  if (terminal_) std::fputc('\n', stderr);
}

}  // namespace windhover::replay
