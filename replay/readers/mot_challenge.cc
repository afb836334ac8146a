// SPDX-License-Identifier: Apache-2.0
// MOTChallenge (motchallenge.net; Milan et al., "MOT16: A Benchmark for Multi-Object Tracking",
// arXiv:1603.00831): seqinfo.ini, img1/, and gt/gt.txt with frame, id, left, top, width, height, a
// flag that is 0 for what does not count, class and visible share; pixels from 1. Classes 1 to 6
// are people and vehicles, 7 people who stand or sit, 8 to 13 things that only look alike, hide
// others or cannot be told apart. Sequences with this program's own truth (homographies, decoys)
// label what moves and nothing else.
#include <array>
#include <opencv2/core.hpp>
#include <string_view>

#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/format/horizon.h"
#include "replay/format/sequence.h"
#include "replay/format/truth.h"
#include "replay/readers/layout_reader.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 13> kClasses = {
    "pedestrian", "person on vehicle", "car",        "bicycle",  "motorbike",
    "vehicle",    "static person",     "distractor", "occluder", "occluder on the ground",
    "occluder",   "reflection",        "crowd"};
constexpr int kLastThatMayMove = 6;

bool Recognises(const fs::path& path) { return fs::exists(path / "seqinfo.ini"); }

void CheckPictures(const fs::path& path, const SequenceInfo& info) {
  for (int frame = 1; frame <= info.frames; ++frame) {
    const fs::path file = FramePath(path, info, frame);
    if (!fs::exists(file)) {
      throw FormatError(file, "is missing, but seqinfo.ini says that there are " +
                                  std::to_string(info.frames) + " frames");
    }
  }
}

Recording Locate(const fs::path& path) {
  const SequenceInfo info = ReadSequenceInfo(path);
  if (!SequenceVideo(path, info)) CheckPictures(path, info);
  Recording recording;
  recording.path = path;
  recording.name = info.name;
  recording.layout = "MOTChallenge";
  recording.width = info.width;
  recording.height = info.height;
  recording.frames = info.frames;
  recording.frame_rate_hz = info.frame_rate_hz;
  recording.open_frames = [path] { return OpenFrames(path); };
  return recording;
}

// A class is a number that the set gives; what it means matters only where standing things are
// labelled, too.
Label ClassifiedLabel(const LabelledBox& box) {
  Label label = {box, "", Occlusion::kNone, false};
  if (box.object_class < 1 || box.object_class > static_cast<int>(kClasses.size())) return label;
  label.category = kClasses[box.object_class - 1];
  if (box.object_class > kLastThatMayMove) label.box.score = 0;
  return label;
}

void ReadTruth(Recording& recording) {
  const SequenceTruth truth(recording.path, 0);
  const bool own = !ReadSequenceInfo(recording.path).rendered_by.empty() ||
                   truth.HasHomographies() || fs::exists(DecoysPath(recording.path));
  if (fs::exists(MoversPath(recording.path))) {
    recording.labelling = own ? Labelling::kMovers : Labelling::kObjects;
    recording.labels_move = own;
    for (const LabelledBox& box : truth.Movers()) {
      recording.labels.push_back(own ? Label{box, "", Occlusion::kNone, false}
                                     : ClassifiedLabel(box));
    }
  }
  if (truth.HasHomographies()) recording.first_from_frame = truth.Homographies();
  if (fs::exists(DecoysPath(recording.path)))
    recording.decoys = ReadBoxes(DecoysPath(recording.path));
  const fs::path horizon = HorizonPath(recording.path);
  if (!fs::exists(horizon)) return;
  recording.horizons = ReadHorizons(horizon);
  if (static_cast<int>(recording.horizons->size()) != recording.frames) {
    throw FormatError(horizon, "is of " + std::to_string(recording.horizons->size()) +
                                   " frames, but seqinfo.ini says that there are " +
                                   std::to_string(recording.frames));
  }
}

}  // namespace

const LayoutReader kMotChallengeReader = {Recognises, Locate, ReadTruth};

}  // namespace windhover::replay
