// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"
#include "replay/app/progress.h"
#include "replay/app/score_inputs.h"
#include "replay/app/score_json.h"
#include "replay/app/score_text.h"
#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/format/text_lines.h"
#include "replay/offline/product_registration.h"

namespace windhover::replay {
namespace {

struct ScoreSettings {
  std::filesystem::path truth;
  std::filesystem::path video;
  std::filesystem::path detections;
  std::filesystem::path homographies;
  std::filesystem::path json;
  std::string device;
  std::vector<double> overlaps;  // empty: the protocol's
  MotionProtocol protocol = MotionProtocol::kWindhover;
  int frames = 0;  // 0: all
  int gap = 0;     // 0: not asked for
  int every = 0;   // 0: the gap
};

constexpr const char* kDetectionsName = "det.txt";
constexpr const char* kHomographiesName = "homography.txt";

void WriteJson(const ScoreSettings& settings, const nlohmann::ordered_json& json) {
  if (!settings.json.empty()) WriteText(settings.json, json.dump(2) + "\n");
}

void ScoreMotionOfAll(const ScoreSettings& settings) {
  const std::vector<ScoredPair> pairs =
      PairUp(settings.truth, settings.detections, kDetectionsName);
  const bool is_one = pairs.size() == 1 && pairs.front().name.empty();
  const std::vector<double> overlaps =
      settings.overlaps.empty() ? DefaultOverlaps(settings.protocol) : settings.overlaps;
  std::vector<MotionReport> reports;
  for (const ScoredPair& pair : pairs) {
    const std::filesystem::path homographies =
        is_one || settings.homographies.empty()
            ? settings.homographies
            : settings.homographies / pair.name / kHomographiesName;
    const MotionTruth truth = MotionTruthOf(pair, homographies, settings.frames);
    reports.push_back(ReportMotion(truth, ReadMeasuredDetections(pair, truth, settings.frames),
                                   overlaps, settings.protocol));
  }
  const MotionReport pooled = Pool(reports);
  WriteJson(settings, MotionJson(reports, pooled, settings.protocol));
  std::fputs((is_one ? Describe(reports.front()) : MotionTable(reports, pooled)).c_str(), stdout);
}

RegistrationScore ScorePair(const ScoreSettings& settings, const ScoredPair& pair, int gap) {
  const Recording truth = OpenTruth(pair.truth, settings.frames);
  if (!truth.first_from_frame) {
    throw FormatError(pair.truth, "has no gt/homography.txt; --video scores without truth");
  }
  const std::vector<Eigen::Vector3d> everywhere;
  return ScoreRegistration(ReadMeasuredHomographies(pair.measured, truth, settings.frames),
                           *truth.first_from_frame, truth.width, truth.height, gap,
                           truth.horizons ? *truth.horizons : everywhere);
}

void ScoreAgainstTruth(const ScoreSettings& settings) {
  const std::vector<ScoredPair> pairs =
      PairUp(settings.truth, settings.homographies, kHomographiesName);
  const bool is_one = pairs.size() == 1 && pairs.front().name.empty();
  std::vector<int> gaps = {1};
  if (settings.gap > 1) gaps.push_back(settings.gap);
  std::string text;
  nlohmann::ordered_json json;
  for (const int gap : gaps) {
    std::vector<NamedRegistrationScore> scores;
    for (const ScoredPair& pair : pairs) {
      scores.push_back({pair.name, ScorePair(settings, pair, gap)});
    }
    if (gap > 1 && !is_one) text += "\n" + std::to_string(gap) + " frames apart\n";
    text += is_one ? Describe(scores.front().score) : RegistrationTable(scores);
    json["gaps"].push_back(RegistrationJson(scores));
  }
  WriteJson(settings, json);
  std::fputs(text.c_str(), stdout);
}

void ScoreWithoutTruth(const ScoreSettings& settings) {
  std::vector<Eigen::Matrix3d> first_from_frame = ReadHomographies(settings.homographies);
  const Recording video = OpenRecordingWithoutTruth(settings.video);
  VideoScoreOptions options;
  if (settings.frames > 0) {
    if (first_from_frame.size() < static_cast<std::size_t>(settings.frames)) {
      throw FormatError(settings.homographies,
                        "is of " + std::to_string(first_from_frame.size()) + " frames, but " +
                            std::to_string(settings.frames) + " are asked for");
    }
    first_from_frame.resize(settings.frames);
    options.from_start = true;
  }
  if (settings.gap > 0) options.gap = settings.gap;
  options.every = settings.every > 0 ? settings.every : options.gap;
  CatchInterrupts();
  const std::shared_ptr<Backend> backend =
      Backend::Create(settings.device, [](const std::string& line) {
        std::fprintf(stderr, "windhover-replay: %s\n", line.c_str());
      });
  // The second picture of a pair has the first to go by, and no anchor.
  RegistrationOptions registration_options;
  registration_options.reference = ReferenceMode::kCentre;
  std::optional<ProductRegistration> registration;
  const PairRegister at_once = [&](const cv::Mat& first, const cv::Mat& second) {
    if (!registration) {
      registration.emplace(backend, first.cols, first.rows, registration_options);
    }
    return RegisterPair(*registration, first, second);
  };
  Progress progress("scoring", static_cast<int>(first_from_frame.size()));
  const std::unique_ptr<FrameSource> source = video.open_frames();
  const VideoScore score =
      ScoreVideo(*source, settings.video.string(), first_from_frame, options, at_once, [&] {
        ThrowIfInterrupted();
        progress.Advance();
      });
  progress.Finish();
  WriteJson(settings, VideoJson(score));
  std::fputs(Describe(score).c_str(), stdout);
}

void AddCommonOptions(CLI::App& command, ScoreSettings& settings) {
  command.add_option("--json", settings.json, "File for the same and more, for scripts");
  command
      .add_option("--frames", settings.frames,
                  "Compare only so many frames from the start; otherwise both must have the same")
      ->check(CLI::Range(1, 100000000));
}

void AddMotionCommand(CLI::App& command, const std::shared_ptr<ScoreSettings>& settings) {
  CLI::App* motion = command.add_subcommand(
      "motion", "Precision, recall and F1 of detections, matched one to one by overlap");
  motion
      ->add_option("--truth", settings->truth,
                   "Sequence with gt/gt.txt, recording of a known set, or a folder of such")
      ->required();
  motion
      ->add_option("--detections", settings->detections,
                   "det.txt, or the JSON lines of 'windhover watch --json' (*.jsonl); for a folder "
                   "of sequences the folder with NAME/det.txt")
      ->required();
  motion
      ->add_option("--overlap", settings->overlaps,
                   "Intersection over union that a hit exceeds; several may be given, the first "
                   "one is that of false alarms, tracks and recall by class")
      ->check(CLI::Range(0.0, 1.0))
      ->delimiter(',')
      ->default_str("0.05,0.25,0.5");
  const std::map<std::string, MotionProtocol> protocols = {
      {"windhover", MotionProtocol::kWindhover}, {"pesmod", MotionProtocol::kPesmod}};
  motion
      ->add_option("--protocol", settings->protocol,
                   "pesmod: without detections of 10 px^2 and less or within 5 px of the border, "
                   "at overlaps 0.5 and 0.25")
      ->transform(CLI::CheckedTransformer(protocols))
      ->default_str("windhover");
  motion->add_option("--homographies", settings->homographies,
                     "Where a set labels objects whether they move or stand: homography.txt of its "
                     "frames, or the folder with NAME/homography.txt");
  AddCommonOptions(*motion, *settings);
  motion->final_callback([settings] { ScoreMotionOfAll(*settings); });
}

void AddRegistrationCommand(CLI::App& command, const std::shared_ptr<ScoreSettings>& settings) {
  CLI::App* registration = command.add_subcommand(
      "registration",
      "RMS distance in px of homographies from truth over the visible ground, or "
      "what they leave on the ground of a video");
  CLI::Option* truth = registration->add_option(
      "--truth", settings->truth, "Sequence with gt/homography.txt, or a folder of such");
  CLI::Option* video = registration
                           ->add_option("--video", settings->video,
                                        "Video or sequence to score without truth, by its pictures")
                           ->excludes(truth);
  registration
      ->add_option("--homographies", settings->homographies,
                   "homography.txt: frame and first_from_frame, row-major; for a folder of "
                   "sequences the folder with NAME/homography.txt")
      ->required();
  registration
      ->add_option("--gap", settings->gap,
                   "Score frames so far apart, too; with --video 10 where nothing else is said")
      ->check(CLI::Range(1, 100000));
  registration
      ->add_option("--every", settings->every,
                   "Frames from one cycle over the gap to the next; the gap where not given")
      ->check(CLI::Range(1, 100000))
      ->needs(video);
  registration->add_option("--device", settings->device, "Compute device, as for 'detect'")
      ->needs(video);
  AddCommonOptions(*registration, *settings);
  registration->final_callback([settings] {
    if (settings->truth.empty() && settings->video.empty()) {
      throw CLI::RequiredError("--truth or --video");
    }
    if (settings->video.empty()) {
      ScoreAgainstTruth(*settings);
    } else {
      ScoreWithoutTruth(*settings);
    }
  });
}

}  // namespace

void AddScoreCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("score", "Compare a result with a sequence's truth");
  command->require_subcommand(1);
  auto settings = std::make_shared<ScoreSettings>();
  AddMotionCommand(*command, settings);
  AddRegistrationCommand(*command, settings);
}

}  // namespace windhover::replay
