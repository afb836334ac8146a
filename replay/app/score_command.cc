// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>

#include "replay/app/commands.h"
#include "replay/app/score_text.h"
#include "replay/format/homographies.h"
#include "replay/format/labels.h"
#include "replay/format/sequence.h"

namespace windhover::replay {
namespace {

struct ScoreSettings {
  std::filesystem::path truth;
  std::filesystem::path measured;
  double overlap = kThesisOverlap;
};

void PrintMotionScore(const ScoreSettings& settings) {
  const MotionScore score = ScoreMotion(ReadBoxes(MoversPath(settings.truth)),
                                        ReadDetections(settings.measured), settings.overlap);
  std::printf("%s\n", Describe(score, settings.overlap).c_str());
}

void PrintRegistrationScore(const ScoreSettings& settings) {
  const SequenceInfo info = ReadSequenceInfo(settings.truth);
  const RegistrationScore score = ScoreRegistration(
      ReadHomographies(settings.measured), ReadHomographies(HomographiesPath(settings.truth)),
      info.width, info.height);
  std::printf("%s\n", Describe(score).c_str());
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
  motion->final_callback([settings] { PrintMotionScore(*settings); });
  CLI::App* registration = command->add_subcommand(
      "registration", "RMS distance in px of homographies from truth over the visible ground");
  registration->add_option("--truth", settings->truth, "Sequence with gt/homography.txt")
      ->required();
  registration
      ->add_option("--homographies", settings->measured,
                   "homography.txt: frame and first_from_frame, row-major")
      ->required();
  registration->final_callback([settings] { PrintRegistrationScore(*settings); });
}

}  // namespace windhover::replay
