// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <thread>

namespace windhover {

// Keeps SIGINT and SIGTERM from ending the process. Call before any thread is started.
void BlockEndSignals();

// Calls back once, from a thread of its own, when the process is asked to end by one of those
// signals. A second signal ends the process. One at a time, after BlockEndSignals().
class SignalThread {
 public:
  explicit SignalThread(std::function<void()> on_signal);
  SignalThread(const SignalThread&) = delete;
  SignalThread& operator=(const SignalThread&) = delete;
  ~SignalThread();

 private:
  std::thread thread_;
};

}  // namespace windhover
