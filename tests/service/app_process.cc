// SPDX-License-Identifier: Apache-2.0
#include "tests/service/app_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <regex>
#include <stdexcept>

extern char** environ;

namespace windhover {
namespace {

constexpr int kPatienceMs = 60000;

std::string NameOf(const std::string& variable) { return variable.substr(0, variable.find('=')); }

std::vector<std::string> Environment(const std::vector<std::string>& changes) {
  std::vector<std::string> all = changes;
#ifdef WINDHOVER_SANITIZED
  // GStreamer's scanner is a program without the sanitizer and cannot load what is built with it.
  all.push_back("GST_REGISTRY_FORK=no");
#endif
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string name = NameOf(*variable);
    const bool changed = std::any_of(
        all.begin(), all.end(), [&](const std::string& change) { return NameOf(change) == name; });
    if (!changed && name != "CYCLONEDDS_URI") all.emplace_back(*variable);
  }
  return all;
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// True when there is something to read from the descriptor in time.
bool Readable(int descriptor) {
  pollfd wait{descriptor, POLLIN, 0};
  return poll(&wait, 1, kPatienceMs) == 1;
}

}  // namespace

Process::Process(const std::vector<std::string>& command,
                 const std::vector<std::string>& environment)
    : errors_(std::tmpfile()) {
  std::array<int, 2> ends{};
  if (errors_ == nullptr || pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe or temporary file");
  }
  output_ = ends[0];
  std::vector<std::string> arguments = command;
  std::vector<std::string> variables = Environment(environment);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, fileno(errors_), STDERR_FILENO);
  const int error = posix_spawn(&pid_, command[0].c_str(), &files, nullptr,
                                Pointers(arguments).data(), Pointers(variables).data());
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (error != 0) throw std::runtime_error("cannot start " + command[0]);
}

Process::~Process() {
  CloseOutput();
  if (pid_ != 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  std::fclose(errors_);
}

std::optional<std::string> Process::ReadLine() {
  std::size_t end = 0;
  while ((end = unread_.find('\n')) == std::string::npos) {
    std::array<char, 4096> bytes{};
    const ssize_t count =
        Readable(output_) ? read(output_, bytes.data(), bytes.size()) : ssize_t{0};
    if (count <= 0) return std::nullopt;
    unread_.append(bytes.data(), static_cast<std::size_t>(count));
  }
  std::string line = unread_.substr(0, end);
  unread_.erase(0, end + 1);
  return line;
}

std::vector<std::string> Process::ReadLines() {
  std::vector<std::string> lines;
  while (auto line = ReadLine()) lines.push_back(*line);
  return lines;
}

void Process::CloseOutput() {
  if (output_ >= 0) close(output_);
  output_ = -1;
}

void Process::Signal(int number) const { kill(pid_, number); }

int Process::Wait() {
  const int end = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  const bool ended = end >= 0 && Readable(end);
  if (end >= 0) close(end);
  if (!ended) return -1;
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Under LeakSanitizer a thread that was joined a moment before the end may still be in the kernel's
// list of threads, and is then told of; that line is not the program's.
std::string Process::ErrorText() const {
  std::string text(1 << 16, '\0');
  const ssize_t count = pread(fileno(errors_), text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  static const std::regex kThreadIsGone(
      "==[0-9]+==Unable to get registers from thread [0-9]+\\.\n");
  return std::regex_replace(text, kThreadIsGone, "");
}

Outcome RunToEnd(const std::vector<std::string>& command,
                 const std::vector<std::string>& environment) {
  Process process(command, environment);
  Outcome outcome;
  outcome.lines = process.ReadLines();
  outcome.exit_code = process.Wait();
  outcome.errors = process.ErrorText();
  return outcome;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "windhover-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> ScratchFolder::Names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace windhover
