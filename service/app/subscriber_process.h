// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace windhover {

// This executable once more, as a process of its own, with its standard output read line by line on
// GLib's main loop. Signals of the terminal do not reach it.
class SubscriberProcess {
 public:
  using OnLine = std::function<void(std::string_view line)>;  // without its line feed
  using OnExit = std::function<void(int status)>;             // wait status, after the last line

  // Throws std::runtime_error where it cannot be started. The functions must not throw.
  SubscriberProcess(const std::vector<std::string>& arguments, OnLine on_line, OnExit on_exit);
  SubscriberProcess(const SubscriberProcess&) = delete;
  SubscriberProcess& operator=(const SubscriberProcess&) = delete;
  // Ends the process where it still runs; the functions are not called any more.
  ~SubscriberProcess();

 private:
  // False when nothing is to be read any more.
  bool Read();

  OnLine on_line_;
  OnExit on_exit_;
  pid_t pid_ = 0;  // 0 when it has ended
  int output_ = -1;
  unsigned output_source_ = 0;  // 0 when the output has been closed
  unsigned exit_source_ = 0;
  std::string unfinished_;
};

}  // namespace windhover
