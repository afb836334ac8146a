// SPDX-License-Identifier: Apache-2.0
#include "service/app/signal_thread.h"

#include <csignal>
#include <initializer_list>
#include <utility>

namespace windhover {
namespace {

// Ends the thread.
constexpr int kLeave = SIGUSR1;

sigset_t Signals(std::initializer_list<int> numbers) {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : numbers) sigaddset(&set, number);
  return set;
}

}  // namespace

void BlockEndSignals() {
  const sigset_t blocked = Signals({SIGINT, SIGTERM, kLeave});
  pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
}

SignalThread::SignalThread(std::function<void()> on_signal) {
  thread_ = std::thread([on_signal = std::move(on_signal)] {
    const sigset_t waited_for = Signals({SIGINT, SIGTERM, kLeave});
    int number = 0;
    if (sigwait(&waited_for, &number) != 0 || number == kLeave) return;
    const sigset_t fatal_from_now_on = Signals({SIGINT, SIGTERM});
    pthread_sigmask(SIG_UNBLOCK, &fatal_from_now_on, nullptr);
    on_signal();
    const sigset_t leave = Signals({kLeave});
    sigwait(&leave, &number);
  });
}

SignalThread::~SignalThread() {
  pthread_kill(thread_.native_handle(), kLeave);
  thread_.join();
}

}  // namespace windhover
