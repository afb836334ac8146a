// SPDX-License-Identifier: Apache-2.0
#include "replay/app/score_inputs.h"

#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/readers/motion_filter.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

// 01 of DIR/01, NAME of anno/UAV123/NAME.txt.
fs::path NameBelow(const fs::path& dataset, const fs::path& recording) {
  fs::path name = recording.lexically_relative(fs::absolute(dataset).lexically_normal());
  if (!fs::is_directory(recording)) name.replace_extension();
  return name;
}

template <typename Value>
void KeepFirst(std::optional<std::vector<Value>>& values, int frames) {
  if (values && values->size() > static_cast<std::size_t>(frames)) values->resize(frames);
}

// Objects that stand no longer count.
void LeaveOutWhatStands(Recording& recording, const fs::path& homographies, int frames) {
  if (recording.labels_move) return;
  if (!recording.first_from_frame) {
    if (homographies.empty()) {
      throw FormatError(recording.path,
                        "labels objects whether they move or stand; --homographies with those of "
                        "its frames tells them apart");
    }
    recording.first_from_frame = ReadMeasuredHomographies(homographies, recording, frames);
  }
  FilterMovers(recording, TrueGroundMotion(*recording.first_from_frame));
}

}  // namespace

std::vector<ScoredPair> PairUp(const fs::path& truth, const fs::path& measured,
                               const std::string& file_name) {
  const std::vector<fs::path> recordings = FindRecordings(truth);
  if (recordings.empty()) {
    throw FormatError(truth, "is no sequence, video or known set, nor does it hold one");
  }
  const bool is_one = recordings.size() == 1 && NameBelow(truth, recordings.front()) == ".";
  if (is_one || !fs::is_directory(truth)) return {{"", truth, measured}};
  if (!fs::is_directory(measured)) {
    throw FormatError(measured, "is no folder, but " + truth.string() +
                                    " holds several recordings; expected NAME/" + file_name +
                                    " for each");
  }
  std::vector<ScoredPair> pairs;
  for (const fs::path& recording : recordings) {
    const fs::path name = NameBelow(truth, recording);
    pairs.push_back({name.string(), recording, measured / name / file_name});
  }
  return pairs;
}

Recording OpenTruth(const fs::path& path, int frames) {
  Recording recording = OpenRecording(path);
  if (recording.frames == 0 && recording.first_from_frame) {
    recording.frames = static_cast<int>(recording.first_from_frame->size());
  }
  if (recording.frames == 0 && frames == 0) {
    throw FormatError(path, "does not say how many frames it has; --frames does");
  }
  if (frames == 0) return recording;
  if (recording.frames != 0 && recording.frames < frames) {
    throw FormatError(path, "has " + std::to_string(recording.frames) + " frames, but " +
                                std::to_string(frames) + " are asked for");
  }
  recording.frames = frames;
  std::erase_if(recording.labels, [&](const Label& label) { return label.box.frame > frames; });
  KeepFirst(recording.first_from_frame, frames);
  KeepFirst(recording.horizons, frames);
  return recording;
}

std::vector<Eigen::Matrix3d> ReadMeasuredHomographies(const fs::path& file, const Recording& truth,
                                                      int frames) {
  std::vector<Eigen::Matrix3d> measured = ReadHomographies(file);
  const auto expected = static_cast<std::size_t>(truth.frames);
  if (measured.size() < expected || (measured.size() > expected && frames == 0)) {
    throw FormatError(file, "is of " + std::to_string(measured.size()) +
                                " frames, but the truth of " + std::to_string(expected) +
                                "; --frames compares only so many from the start");
  }
  measured.resize(expected);
  return measured;
}

MotionTruth MotionTruthOf(const ScoredPair& pair, const fs::path& homographies, int frames) {
  Recording recording = OpenTruth(pair.truth, frames);
  if (recording.labelling == Labelling::kNone) throw FormatError(pair.truth, "labels nothing");
  LeaveOutWhatStands(recording, homographies, frames);
  MotionTruth truth;
  truth.name = pair.name;
  truth.boxes = recording.Truth();
  truth.frames = recording.frames;
  truth.width = recording.width;
  truth.height = recording.height;
  truth.frame_rate_hz = recording.frame_rate_hz;
  if (recording.first_from_frame) truth.first_from_frame = *recording.first_from_frame;
  truth.complete = recording.labelling != Labelling::kOneTarget;
  return truth;
}

std::vector<LabelledBox> ReadMeasuredDetections(const ScoredPair& pair, const MotionTruth& truth,
                                                int frames) {
  std::vector<LabelledBox> detections = ReadDetections(pair.measured);
  if (frames > 0) {
    std::erase_if(detections, [&](const LabelledBox& box) { return box.frame > frames; });
  }
  for (const LabelledBox& box : detections) {
    if (box.frame > truth.frames) {
      throw FormatError(pair.measured, "has a box in frame " + std::to_string(box.frame) +
                                           ", but the truth is of " + std::to_string(truth.frames) +
                                           " frames");
    }
  }
  return detections;
}

}  // namespace windhover::replay
