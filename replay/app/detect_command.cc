// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"
#include "replay/app/progress.h"
#include "replay/app/score_text.h"
#include "replay/format/format_error.h"
#include "replay/format/frame_source.h"
#include "replay/format/homographies.h"
#include "replay/format/labels.h"
#include "replay/format/sequence.h"
#include "replay/offline/offline_detection.h"
#include "replay/offline/overlay.h"

namespace windhover::replay {
namespace {

struct DetectSettings {
  std::filesystem::path source;
  std::filesystem::path out;
  std::vector<std::string> assignments;
  std::filesystem::path truth;
  std::filesystem::path overlay;
  int every = 10;
  int frames = 0;
};

using BoxesByFrame = std::map<int, std::vector<LabelledBox>>;

BoxesByFrame ByFrame(const std::vector<LabelledBox>& boxes) {
  BoxesByFrame sorted;
  for (const LabelledBox& box : boxes) sorted[box.frame].push_back(box);
  return sorted;
}

std::vector<FrameOutcome> RunDetection(const DetectSettings& settings,
                                       const OfflineOptions& options) {
  const std::unique_ptr<FrameSource> source = OpenFrames(settings.source);
  const std::shared_ptr<Backend> backend =
      Backend::Create(options.device.device, [](const std::string& line) {
        std::fprintf(stderr, "windhover-replay: %s\n", line.c_str());
      });
  std::fprintf(stderr, "device: %s\n", backend->device().Describe().c_str());
  std::unique_ptr<OfflineDetection> detection;
  Progress progress("detecting", settings.frames > 0 ? std::min(settings.frames, source->frames())
                                                     : source->frames());
  const auto start = std::chrono::steady_clock::now();
  int frames = 0;
  for (cv::Mat frame = source->Next(); !frame.empty(); frame = source->Next()) {
    ThrowIfInterrupted();
    if (!detection) {
      detection = std::make_unique<OfflineDetection>(backend, frame.cols, frame.rows, options);
    }
    detection->Push(frame);
    progress.Advance();
    if (++frames == settings.frames) break;
  }
  if (!detection) throw FormatError(settings.source, "holds no frame");
  detection->Drain();
  progress.Finish();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::fprintf(stderr, "%d frames in %.1f s\n", frames, seconds);
  return detection->outcomes();
}

std::vector<LabelledBox> Boxes(const std::vector<FrameOutcome>& outcomes) {
  std::vector<LabelledBox> boxes;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    for (const Detection& detection : outcomes[i].detections) {
      boxes.push_back({static_cast<int>(i) + 1, static_cast<std::int64_t>(detection.track_id),
                       detection.box, detection.score});
    }
  }
  return boxes;
}

// Boxes of frames that were run.
std::vector<LabelledBox> TruthUpTo(const std::filesystem::path& sequence, std::size_t frames) {
  std::vector<LabelledBox> truth = ReadBoxes(MoversPath(sequence));
  std::erase_if(truth,
                [frames](const LabelledBox& box) { return box.frame > static_cast<int>(frames); });
  return truth;
}

void PrintScores(const DetectSettings& settings, const std::vector<FrameOutcome>& outcomes) {
  const std::vector<LabelledBox> truth = TruthUpTo(settings.truth, outcomes.size());
  std::printf("%s\n", Describe(ScoreMotion(truth, Boxes(outcomes)), kThesisOverlap).c_str());
  if (!std::filesystem::exists(HomographiesPath(settings.truth))) return;
  const SequenceInfo info = ReadSequenceInfo(settings.truth);
  std::vector<Eigen::Matrix3d> homographies = ReadHomographies(HomographiesPath(settings.truth));
  homographies.resize(std::min(homographies.size(), outcomes.size()));
  std::printf("%s\n", Describe(ScoreRegistration(FirstFromFrame(outcomes), homographies, info.width,
                                                 info.height))
                          .c_str());
}

void WriteOverlays(const DetectSettings& settings, const std::vector<FrameOutcome>& outcomes) {
  std::filesystem::create_directories(settings.overlay);
  BoxesByFrame detections = ByFrame(Boxes(outcomes));
  BoxesByFrame truth;
  if (!settings.truth.empty()) truth = ByFrame(TruthUpTo(settings.truth, outcomes.size()));
  const std::unique_ptr<FrameSource> source = OpenFrames(settings.source);
  for (int number = 1; number <= static_cast<int>(outcomes.size()); ++number) {
    ThrowIfInterrupted();
    cv::Mat frame = source->Next();
    if ((number - 1) % settings.every != 0) continue;
    DrawBoxes(frame, detections[number], settings.truth.empty() ? nullptr : &truth[number],
              "frame " + std::to_string(number));
    SequenceInfo names;
    names.image_folder.clear();
    const std::filesystem::path file = FramePath(settings.overlay, names, number);
    if (!cv::imwrite(file.string(), frame)) throw FormatError(file, "cannot be written");
  }
}

void Detect(const DetectSettings& settings) {
  OfflineOptions options;
  for (const std::string& assignment : settings.assignments) SetOption(options, assignment);
  CatchInterrupts();
  const std::vector<FrameOutcome> outcomes = RunDetection(settings, options);
  const auto lost = std::count_if(outcomes.begin(), outcomes.end(), [](const FrameOutcome& one) {
    return one.registration.quality == RegistrationQuality::kLost;
  });
  const std::vector<LabelledBox> boxes = Boxes(outcomes);
  WriteDetections(settings.out / "det.txt", boxes);
  WriteHomographies(settings.out / "homography.txt", FirstFromFrame(outcomes));
  std::printf("%zu frames, %zu boxes, %lld lost\n", outcomes.size(), boxes.size(),
              static_cast<long long>(lost));
  if (!settings.truth.empty()) PrintScores(settings, outcomes);
  if (!settings.overlay.empty()) WriteOverlays(settings, outcomes);
}

}  // namespace

void AddDetectCommand(CLI::App& app) {
  auto settings = std::make_shared<DetectSettings>();
  CLI::App* command = app.add_subcommand(
      "detect", "Run registration and motion detection on a sequence or video, deterministically");
  command->add_option("source", settings->source, "Sequence folder or video file")->required();
  command->add_option("--out", settings->out, "Folder for det.txt and homography.txt")->required();
  command->add_option("--set", settings->assignments, "option=value; may be repeated");
  command->add_option("--frames", settings->frames, "Only so many frames from the start")
      ->check(CLI::Range(1, 100000000));
  command->add_option("--truth", settings->truth,
                      "Sequence whose truth is compared with the result; never read otherwise");
  command->add_option("--overlay", settings->overlay,
                      "Folder for pictures with boxes: green hit, red false alarm, yellow miss");
  command->add_option("--every", settings->every, "Frames from one such picture to the next")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->final_callback([settings] { Detect(*settings); });
}

}  // namespace windhover::replay
