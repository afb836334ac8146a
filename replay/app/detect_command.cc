// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
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
#include "replay/format/truth.h"
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

// What a result is compared with, read before there is one.
struct Truth {
  SequenceTruth sequence;
  std::vector<LabelledBox> movers;
  std::vector<Eigen::Matrix3d> first_from_frame;  // empty where the sequence has none
  std::vector<Eigen::Vector3d> horizons;          // the same
};

std::optional<Truth> ReadTruth(const DetectSettings& settings) {
  if (settings.truth.empty()) return std::nullopt;
  Truth truth = {SequenceTruth(settings.truth, settings.frames), {}, {}, {}};
  truth.movers = truth.sequence.Movers();
  if (truth.sequence.HasHomographies()) truth.first_from_frame = truth.sequence.Homographies();
  truth.horizons = truth.sequence.Horizons();
  return truth;
}

// A result for other frames than those of the truth is no result: scoring what both have would hide
// that the source broke off.
void CheckLength(const DetectSettings& settings, const Truth& truth, int frames) {
  if (frames == truth.sequence.frames()) return;
  throw FormatError(settings.source, "gives " + std::to_string(frames) +
                                         " frames, but the truth is of " +
                                         std::to_string(truth.sequence.frames()) +
                                         "; --frames compares only so many from the start");
}

void CheckSize(const DetectSettings& settings, const Truth& truth, const cv::Mat& frame) {
  const auto text = [](int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  if (frame.cols == truth.sequence.width() && frame.rows == truth.sequence.height()) return;
  throw FormatError(settings.source, "is of " + text(frame.cols, frame.rows) +
                                         " px, but the truth of " +
                                         text(truth.sequence.width(), truth.sequence.height()));
}

// How many frames there should be; 0 where nothing says.
int FramesToCome(const DetectSettings& settings, const FrameSource& source) {
  if (settings.frames == 0) return source.frames();
  return source.knows_frames() ? std::min(settings.frames, source.frames()) : settings.frames;
}

std::vector<FrameOutcome> RunDetection(const DetectSettings& settings,
                                       const OfflineOptions& options, FrameSource& source,
                                       const std::optional<Truth>& truth) {
  const std::shared_ptr<Backend> backend =
      Backend::Create(options.device.device, [](const std::string& line) {
        std::fprintf(stderr, "windhover-replay: %s\n", line.c_str());
      });
  std::fprintf(stderr, "device: %s\n", backend->device().Describe().c_str());
  std::unique_ptr<OfflineDetection> detection;
  const int to_come = FramesToCome(settings, source);
  Progress progress("detecting", to_come);
  const auto start = std::chrono::steady_clock::now();
  int frames = 0;
  for (cv::Mat frame = source.Next(); !frame.empty(); frame = source.Next()) {
    ThrowIfInterrupted();
    if (!detection) {
      if (truth) CheckSize(settings, *truth, frame);
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
  if (frames < to_come) {
    std::fprintf(stderr, "windhover-replay: %s: %d frames were to come, %d could be read\n",
                 settings.source.c_str(), to_come, frames);
  }
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

void PrintScores(const Truth& truth, const std::vector<FrameOutcome>& outcomes) {
  const SequenceTruth& sequence = truth.sequence;
  const MotionTruth motion = {"",
                              truth.movers,
                              sequence.frames(),
                              sequence.width(),
                              sequence.height(),
                              sequence.frame_rate_hz(),
                              truth.first_from_frame};
  const MotionReport report =
      ReportMotion(motion, Boxes(outcomes), DefaultOverlaps(MotionProtocol::kWindhover));
  std::fputs(Describe(report).c_str(), stdout);
  if (truth.first_from_frame.empty()) return;
  const RegistrationScore registration =
      ScoreRegistration(FirstFromFrame(outcomes), truth.first_from_frame, sequence.width(),
                        sequence.height(), 1, truth.horizons);
  std::fputs(Describe(registration).c_str(), stdout);
}

void WriteOverlays(const DetectSettings& settings, const std::vector<FrameOutcome>& outcomes,
                   const std::optional<Truth>& truth) {
  BoxesByFrame detections = ByFrame(Boxes(outcomes));
  BoxesByFrame movers;
  if (truth) movers = ByFrame(truth->movers);
  const std::unique_ptr<FrameSource> source = OpenFrames(settings.source);
  for (int number = 1; number <= static_cast<int>(outcomes.size()); ++number) {
    ThrowIfInterrupted();
    cv::Mat frame = source->Next();
    if ((number - 1) % settings.every != 0) continue;
    DrawBoxes(frame, detections[number], truth ? &movers[number] : nullptr,
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
  const std::unique_ptr<FrameSource> source = OpenFrames(settings.source);
  const std::optional<Truth> truth = ReadTruth(settings);
  if (truth && source->knows_frames()) {
    CheckLength(settings, *truth, FramesToCome(settings, *source));
  }
  std::filesystem::create_directories(settings.out);
  if (!settings.overlay.empty()) std::filesystem::create_directories(settings.overlay);
  CatchInterrupts();
  const std::vector<FrameOutcome> outcomes = RunDetection(settings, options, *source, truth);
  if (truth) CheckLength(settings, *truth, static_cast<int>(outcomes.size()));
  const auto lost = std::count_if(outcomes.begin(), outcomes.end(), [](const FrameOutcome& one) {
    return one.registration.quality == RegistrationQuality::kLost;
  });
  const std::vector<LabelledBox> boxes = Boxes(outcomes);
  WriteDetections(settings.out / "det.txt", boxes);
  WriteHomographies(settings.out / "homography.txt", FirstFromFrame(outcomes));
  std::printf("%zu frames, %zu boxes, %lld lost\n", outcomes.size(), boxes.size(),
              static_cast<long long>(lost));
  if (truth) PrintScores(*truth, outcomes);
  if (settings.overlay.empty()) return;
  try {
    WriteOverlays(settings, outcomes, truth);
  } catch (const Interrupted&) {
    throw Interrupted("det.txt and homography.txt are complete, the pictures are not");
  }
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
                      "Sequence whose truth is compared with the result, frame by frame; never "
                      "read otherwise");
  command->add_option("--overlay", settings->overlay,
                      "Folder for pictures with boxes: green hit, red false alarm, yellow miss");
  command->add_option("--every", settings->every, "Frames from one such picture to the next")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->final_callback([settings] { Detect(*settings); });
}

}  // namespace windhover::replay
