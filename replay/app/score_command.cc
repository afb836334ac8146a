// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "replay/app/commands.h"
#include "replay/app/score_text.h"
#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/format/labels.h"
#include "replay/format/truth.h"

namespace windhover::replay {
namespace {

struct ScoreSettings {
  std::filesystem::path truth;
  std::filesystem::path measured;
  double overlap = kThesisOverlap;
  int frames = 0;  // 0: all
};

void PrintMotionScore(const ScoreSettings& settings) {
  const SequenceTruth truth(settings.truth, settings.frames);
  std::vector<LabelledBox> detections = ReadDetections(settings.measured);
  if (settings.frames > 0) {
    std::erase_if(detections, [&](const LabelledBox& box) { return box.frame > settings.frames; });
  }
  for (const LabelledBox& box : detections) {
    if (box.frame > truth.frames()) {
      throw FormatError(settings.measured, "has a box in frame " + std::to_string(box.frame) +
                                               ", but the truth is of " +
                                               std::to_string(truth.frames()) + " frames");
    }
  }
  const MotionScore score = ScoreMotion(truth.Movers(), detections, settings.overlap);
  std::printf("%s\n", Describe(score, settings.overlap).c_str());
}

void PrintRegistrationScore(const ScoreSettings& settings) {
  const SequenceTruth truth(settings.truth, settings.frames);
  std::vector<Eigen::Matrix3d> measured = ReadHomographies(settings.measured);
  const auto expected = static_cast<std::size_t>(truth.frames());
  if (measured.size() < expected || (measured.size() > expected && settings.frames == 0)) {
    throw FormatError(settings.measured, "is of " + std::to_string(measured.size()) +
                                             " frames, but the truth of " +
                                             std::to_string(expected) +
                                             "; --frames compares only so many from the start");
  }
  measured.resize(expected);
  const RegistrationScore score =
      ScoreRegistration(measured, truth.Homographies(), truth.width(), truth.height());
  std::printf("%s\n", Describe(score).c_str());
}

void AddFramesOption(CLI::App& command, ScoreSettings& settings) {
  command
      .add_option("--frames", settings.frames,
                  "Compare only so many frames from the start; otherwise both must have the same")
      ->check(CLI::Range(1, 100000000));
}

}  // namespace

void AddScoreCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("score", "Compare a result with a sequence's truth");
  command->require_subcommand(1);
  auto settings = std::make_shared<ScoreSettings>();
  CLI::App* motion = command->add_subcommand(
      "motion", "Precision, recall and F1 of detections, matched one to one by overlap");
  motion->add_option("--truth", settings->truth, "Sequence with gt/gt.txt")->required();
  motion
      ->add_option("--detections", settings->measured,
                   "det.txt, or the JSON lines of 'windhover watch --json' (*.jsonl)")
      ->required();
  motion->add_option("--overlap", settings->overlap, "Intersection over union that a hit exceeds")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  AddFramesOption(*motion, *settings);
  motion->final_callback([settings] { PrintMotionScore(*settings); });
  CLI::App* registration = command->add_subcommand(
      "registration", "RMS distance in px of homographies from truth over the visible ground");
  registration->add_option("--truth", settings->truth, "Sequence with gt/homography.txt")
      ->required();
  registration
      ->add_option("--homographies", settings->measured,
                   "homography.txt: frame and first_from_frame, row-major")
      ->required();
  AddFramesOption(*registration, *settings);
  registration->final_callback([settings] { PrintRegistrationScore(*settings); });
}

}  // namespace windhover::replay
