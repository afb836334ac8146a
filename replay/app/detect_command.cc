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
#include "replay/format/pending_file.h"
#include "replay/format/sequence.h"
#include "replay/format/truth.h"
#include "replay/offline/detection.h"
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
  bool video = false;
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

void CheckSize(const DetectSettings& settings, const Truth& truth, int width, int height) {
  const auto text = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  if (width == truth.sequence.width() && height == truth.sequence.height()) return;
  throw FormatError(settings.source, "is of " + text(width, height) + " px, but the truth of " +
                                         text(truth.sequence.width(), truth.sequence.height()));
}

// What a sequence says of itself can be compared before the work.
void CheckSequence(const DetectSettings& settings, const Truth& truth) {
  if (!std::filesystem::exists(settings.source / "seqinfo.ini")) return;
  const SequenceInfo info = ReadSequenceInfo(settings.source);
  CheckSize(settings, truth, info.width, info.height);
  CheckLength(settings, truth,
              settings.frames > 0 ? std::min(settings.frames, info.frames) : info.frames);
}

std::vector<FrameOutcome> RunDetection(const DetectSettings& settings,
                                       const DetectionSettings& detection) {
  Progress progress("detecting");
  const auto start = std::chrono::steady_clock::now();
  const DetectionWatch watch = {[&](const DetectionState& state) {
                                  ThrowIfInterrupted();
                                  progress.AdvanceTo(state.frames, state.to_come);
                                },
                                [](const std::string& line) {
                                  std::fprintf(stderr, "windhover-replay: %s\n", line.c_str());
                                }};
  std::vector<FrameOutcome> outcomes = DetectInSource(settings.source, detection, watch);
  progress.Finish();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::fprintf(stderr, "%zu frames in %.1f s\n", outcomes.size(), seconds);
  return outcomes;
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
      ReportMotion(motion, BoxesOf(outcomes), DefaultOverlaps(MotionProtocol::kWindhover));
  std::fputs(Describe(report).c_str(), stdout);
  if (truth.first_from_frame.empty()) return;
  const RegistrationScore registration =
      ScoreRegistration(FirstFromFrame(outcomes), truth.first_from_frame, sequence.width(),
                        sequence.height(), 1, truth.horizons);
  std::fputs(Describe(registration).c_str(), stdout);
}

void WriteOverlays(const DetectSettings& settings, const std::vector<FrameOutcome>& outcomes,
                   const std::optional<Truth>& truth) {
  BoxesByFrame detections = ByFrame(BoxesOf(outcomes));
  BoxesByFrame movers;
  if (truth) movers = ByFrame(truth->movers);
  const std::unique_ptr<FrameSource> source = OpenFrames(settings.source);
  for (int number = 1; number <= static_cast<int>(outcomes.size()); ++number) {
    ThrowIfInterrupted();
    cv::Mat frame = source->Next();
    if (frame.empty()) throw FormatError(settings.source, "ends early when read again");
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
  DetectionSettings detection;
  for (const std::string& assignment : settings.assignments) {
    detection.options.push_back(ParsePipelineOption(assignment));
  }
  detection.frames = settings.frames;
  if (!std::filesystem::exists(settings.source)) {
    throw FormatError(settings.source, "does not exist");
  }
  const std::optional<Truth> truth = ReadTruth(settings);
  if (truth) CheckSequence(settings, *truth);
  std::filesystem::create_directories(settings.out);
  if (!settings.overlay.empty()) std::filesystem::create_directories(settings.overlay);
  std::optional<PendingFile> video;
  if (settings.video) detection.video = video.emplace(settings.out / "annotated.mp4").temporary();
  CatchInterrupts();
  const std::vector<FrameOutcome> outcomes = RunDetection(settings, detection);
  if (truth) {
    CheckSize(settings, *truth, outcomes.front().width, outcomes.front().height);
    CheckLength(settings, *truth, static_cast<int>(outcomes.size()));
  }
  const auto lost = std::count_if(outcomes.begin(), outcomes.end(), [](const FrameOutcome& one) {
    return one.registration.quality == RegistrationQuality::kLost;
  });
  const std::vector<LabelledBox> boxes = BoxesOf(outcomes);
  WriteDetections(settings.out / "det.txt", boxes);
  WriteHomographies(settings.out / "homography.txt", FirstFromFrame(outcomes));
  if (video) video->Complete();
  std::printf("%zu frames, %zu boxes, %lld lost\n", outcomes.size(), boxes.size(),
              static_cast<long long>(lost));
  if (truth) PrintScores(*truth, outcomes);
  if (settings.overlay.empty()) return;
  try {
    WriteOverlays(settings, outcomes, truth);
  } catch (const Interrupted&) {
    throw Interrupted("the results are complete, the pictures are not");
  }
}

}  // namespace

void AddDetectCommand(CLI::App& app) {
  auto settings = std::make_shared<DetectSettings>();
  CLI::App* command = app.add_subcommand(
      "detect",
      "Run the elements on a sequence or video as fast as they can: the same result every time");
  command
      ->add_option("source", settings->source,
                   "Sequence folder, video file or folder with one video")
      ->required();
  command->add_option("--out", settings->out, "Folder for det.txt and homography.txt")->required();
  command->add_option("--set", settings->assignments,
                      "option=value of the elements; may be repeated");
  command->add_option("--frames", settings->frames, "Only so many frames from the start")
      ->check(CLI::Range(1, 100000000));
  command->add_flag("--video", settings->video,
                    "Write annotated.mp4, too, as 'windhover run' draws it");
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
