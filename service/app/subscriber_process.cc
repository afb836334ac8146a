// SPDX-License-Identifier: Apache-2.0
#include "service/app/subscriber_process.h"

#include <fcntl.h>
#include <glib-unix.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

extern char** environ;

namespace windhover {
namespace {

// In a process group of its own, with signals as a fresh process has them.
pid_t Spawn(const std::vector<std::string>& arguments, int output) {
  const std::string executable = std::filesystem::read_symlink("/proc/self/exe").string();
  std::vector<char*> argv = {const_cast<char*>(executable.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t pid = 0;
  const int error =
      posix_spawn(&pid, executable.c_str(), &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    throw std::system_error(error, std::generic_category(), "Cannot start the subscriber");
  }
  return pid;
}

}  // namespace

SubscriberProcess::SubscriberProcess(const std::vector<std::string>& arguments, OnLine on_line,
                                     OnExit on_exit)
    : on_line_(std::move(on_line)), on_exit_(std::move(on_exit)) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "Cannot make a pipe");
  }
  output_ = ends[0];
  fcntl(output_, F_SETFL, O_NONBLOCK);
  try {
    pid_ = Spawn(arguments, ends[1]);
  } catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);
  output_source_ = g_unix_fd_add(
      output_, static_cast<GIOCondition>(G_IO_IN | G_IO_HUP | G_IO_ERR),
      [](int, GIOCondition, gpointer data) -> gboolean {
        auto& self = *static_cast<SubscriberProcess*>(data);
        if (self.Read()) return G_SOURCE_CONTINUE;
        self.output_source_ = 0;
        return G_SOURCE_REMOVE;
      },
      this);
  exit_source_ = g_child_watch_add(
      pid_,
      [](GPid, int status, gpointer data) {
        auto& self = *static_cast<SubscriberProcess*>(data);
        self.pid_ = 0;
        self.exit_source_ = 0;
        // What it wrote last may not have been read yet.
        self.Read();
        self.on_exit_(status);
      },
      this);
}

SubscriberProcess::~SubscriberProcess() {
  if (output_source_ != 0) g_source_remove(output_source_);
  if (exit_source_ != 0) g_source_remove(exit_source_);
  close(output_);
  if (pid_ != 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

bool SubscriberProcess::Read() {
  std::array<char, 65536> bytes;
  while (true) {
    const ssize_t count = read(output_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN;
    if (count == 0) return false;
    unfinished_.append(bytes.data(), static_cast<std::size_t>(count));
    std::size_t start = 0;
    for (std::size_t end; (end = unfinished_.find('\n', start)) != std::string::npos;
         start = end + 1) {
      on_line_(std::string_view(unfinished_).substr(start, end - start));
    }
    unfinished_.erase(0, start);
  }
}

}  // namespace windhover
