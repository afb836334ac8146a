// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/first_frame.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "replay/benchmarks/timing.h"
#include "replay/format/format_error.h"
#include "replay/format/frame_source.h"
#include "replay/offline/product_registration.h"

namespace windhover::replay {
namespace {

constexpr int kWarmRuns = 5;
// Where the program, PoCL and NVIDIA's driver keep what they have compiled.
constexpr const char* kCacheVariables[] = {"XDG_CACHE_HOME", "POCL_CACHE_DIR", "CUDA_CACHE_PATH"};

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "windhover-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw std::system_error(errno, std::generic_category(), name);
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::vector<std::string> EnvironmentWithCachesIn(const std::filesystem::path& folder) {
  std::vector<std::string> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    bool replaced = false;
    for (const char* name : kCacheVariables)
      replaced |= text.rfind(name + std::string("="), 0) == 0;
    if (!replaced) environment.push_back(text);
  }
  for (const char* name : kCacheVariables) {
    environment.push_back(name + std::string("=") + folder.string());
  }
  return environment;
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// Seconds that the process lives.
double TimeProcess(std::vector<std::string> command, std::vector<std::string> environment) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const Clock::time_point start = Clock::now();
  pid_t process = 0;
  const int failure = posix_spawn(&process, command.front().c_str(), &actions, nullptr,
                                  Pointers(command).data(), Pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::system_error(failure, std::generic_category(), command.front());
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  const double seconds = Milliseconds(Clock::now() - start) / 1000;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error("the first frame could not be timed: the process failed");
  }
  return seconds;
}

}  // namespace

void RegisterFirstPair(const std::filesystem::path& sequence, const std::string& device) {
  const std::unique_ptr<FrameSource> source = OpenFrames(sequence);
  const cv::Mat frames[] = {source->Next(), source->Next()};
  if (frames[1].empty()) throw FormatError(sequence, "has less than two frames");
  ProductRegistration registration(Backend::Create(device), frames[0].cols, frames[0].rows, {});
  cv::Mat gray;
  for (const cv::Mat& frame : frames) {
    cv::cvtColor(frame, gray, cv::COLOR_BGR2GRAY);
    registration.Register(gray);
  }
}

FirstFrameSeconds TimeFirstFrame(const std::filesystem::path& program,
                                 const std::filesystem::path& sequence) {
  const TemporaryFolder caches;
  const std::vector<std::string> command = {program.string(), "bench", "first-frame",
                                            sequence.string()};
  const std::vector<std::string> environment = EnvironmentWithCachesIn(caches.path());
  FirstFrameSeconds seconds;
  seconds.cold = TimeProcess(command, environment);
  std::vector<double> warm;
  for (int i = 0; i < kWarmRuns; ++i) warm.push_back(TimeProcess(command, environment));
  seconds.warm = Quantile(warm, 0.5);
  return seconds;
}

}  // namespace windhover::replay
