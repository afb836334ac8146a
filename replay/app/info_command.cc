// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"
#include "replay/app/progress.h"
#include "replay/app/recording_text.h"
#include "replay/format/format_error.h"
#include "replay/offline/offline_registration.h"
#include "replay/readers/motion_filter.h"
#include "replay/readers/recording.h"

namespace windhover::replay {
namespace {

struct InfoSettings {
  std::filesystem::path path;
  DeviceOptions device;
  MotionFilterOptions filter;
  int frames = -1;  // to measure; -1: all, 0: none
  bool measure = false;
  bool json = false;
};

GroundMotion Measure(const InfoSettings& settings, const std::shared_ptr<Backend>& backend,
                     Recording& recording) {
  const int most = std::max(0, settings.frames);
  const int to_come = most > 0 && recording.frames > 0 ? std::min(most, recording.frames)
                                                       : std::max(most, recording.frames);
  Progress progress("measuring " + recording.name, to_come);
  const std::unique_ptr<FrameSource> source = recording.open_frames();
  const std::vector<FrameRegistration> registrations =
      RegisterFrames(*source, backend, RegistrationOptions(), most, [&] {
        ThrowIfInterrupted();
        progress.Advance();
      });
  progress.Finish();
  if (registrations.empty()) throw FormatError(recording.path, "holds no frame");
  if (most == 0) {
    recording.frames = static_cast<int>(registrations.size());
    recording.knows_frames = true;
  }
  return MeasuredGroundMotion(registrations);
}

// Truth knows better where the ground is.
void Filter(const InfoSettings& settings, const GroundMotion& motion, Recording& recording) {
  if (motion.first_from_frame.size() < static_cast<std::size_t>(recording.frames)) return;
  FilterMovers(recording, motion, settings.filter);
}

class Describer {
 public:
  explicit Describer(const InfoSettings& settings) : settings_(settings) {}

  RecordingSummary Summarise(const std::filesystem::path& path) {
    RecordingSummary summary = {OpenRecording(path), std::nullopt, std::nullopt};
    Recording& recording = summary.recording;
    if (recording.first_from_frame) {
      const GroundMotion motion = TrueGroundMotion(*recording.first_from_frame);
      summary.true_camera = Statistics(recording, motion);
      Filter(settings_, motion, recording);
    }
    if (settings_.frames != 0 && (settings_.measure || !summary.true_camera)) {
      const GroundMotion motion = Measure(settings_, Device(), recording);
      summary.measured_camera = Statistics(recording, motion);
      Filter(settings_, motion, recording);
    }
    return summary;
  }

 private:
  // Made where something is to be measured.
  const std::shared_ptr<Backend>& Device() {
    if (!backend_) {
      backend_ = Backend::Create(settings_.device.device, [](const std::string& line) {
        std::fprintf(stderr, "windhover-replay: %s\n", line.c_str());
      });
    }
    return backend_;
  }

  static CameraStatistics Statistics(const Recording& recording, const GroundMotion& motion) {
    const std::vector<Eigen::Vector3d> none;
    return SummariseCamera(motion, recording.width, recording.height,
                           recording.horizons ? *recording.horizons : none);
  }

  const InfoSettings& settings_;
  std::shared_ptr<Backend> backend_;
};

// Throws after all that can be described has been, if something could not.
void Info(const InfoSettings& settings) {
  const std::vector<std::filesystem::path> paths = FindRecordings(settings.path);
  if (paths.empty()) {
    throw FormatError(settings.path, "is no sequence, video or known set, nor does it hold one");
  }
  CatchInterrupts();
  Describer describer(settings);
  nlohmann::ordered_json json;
  json["recordings"] = nlohmann::ordered_json::array();
  std::size_t failed = 0;
  std::int64_t frames = 0;
  for (const std::filesystem::path& path : paths) {
    try {
      const RecordingSummary summary = describer.Summarise(path);
      frames += summary.recording.frames;
      json["recordings"].push_back(ToJson(summary));
      if (!settings.json) std::printf("%s\n", Describe(summary).c_str());
    } catch (const FormatError& error) {
      if (paths.size() == 1) throw;
      ++failed;
      json["recordings"].push_back({{"path", path.string()}, {"error", error.what()}});
      if (!settings.json) std::printf("%s\n  error: %s\n", path.c_str(), error.what());
    }
  }
  json["frames"] = frames;
  if (settings.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else if (paths.size() > 1) {
    std::printf("%s\n", fmt::format("{} recordings, {} frames", paths.size(), frames).c_str());
  }
  if (failed > 0) {
    throw std::runtime_error(
        fmt::format("{} of {} recordings cannot be read", failed, paths.size()));
  }
}

}  // namespace

void AddInfoCommand(CLI::App& app) {
  auto settings = std::make_shared<InfoSettings>();
  CLI::App* command = app.add_subcommand(
      "info", "Describe a sequence, a dataset, a video or a recording of a known set");
  command->add_option("path", settings->path, "File or folder")->required();
  command->add_flag("--measure", settings->measure,
                    "Measure the camera's motion from the frames, even where truth has it");
  command
      ->add_option("--frames", settings->frames,
                   "Measure over so many frames from the start only; 0 measures nothing")
      ->check(CLI::Range(0, 100000000));
  command
      ->add_option("--moves-px", settings->filter.distance_px,
                   "A labelled object moves where it travels more than this over the ground")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command->add_option("--moves-frames", settings->filter.frames, "... in so many frames")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--device", settings->device.device, "Compute device, as for 'detect'");
  command->add_flag("--json", settings->json, "For scripts");
  command->final_callback([settings] { Info(*settings); });
}

}  // namespace windhover::replay
