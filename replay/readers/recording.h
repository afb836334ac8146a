// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "replay/format/frame_source.h"
#include "replay/format/labels.h"

namespace windhover::replay {

// What the labels of a recording are of.
enum class Labelling : std::uint8_t {
  kNone,       // nothing is labelled
  kMovers,     // all that moves
  kObjects,    // objects of some classes, whether they move or stand: see FilterMovers
  kOneTarget,  // one object; others may move unlabelled, so that no false alarm can be told
};

enum class Occlusion : std::uint8_t { kNone, kPartial, kHeavy };

struct Label {
  LabelledBox box;       // score 0: do not count
  std::string category;  // the set's own name for the class; empty where it has none
  Occlusion occlusion = Occlusion::kNone;
  bool truncated = false;  // part of the object lies outside the picture
};

// One video with what is known about it, whatever the set that it is from. Frames count from 1
// everywhere, boxes are in 0-based px.
struct Recording {
  std::filesystem::path path;
  std::string name;
  std::string layout;  // the set or form it is stored in, for people
  int width = 0;       // px
  int height = 0;      // px
  int frames = 0;      // 0 where a video does not say
  // Whether `frames` is certain (FrameSource::knows_frames).
  bool knows_frames = true;
  std::optional<double> frame_rate_hz;
  // A source that starts at the first frame. May be called again and again.
  std::function<std::unique_ptr<FrameSource>()> open_frames;

  Labelling labelling = Labelling::kNone;
  std::vector<Label> labels;
  // Whether a label that counts is sure to move: true for kMovers, and after FilterMovers.
  bool labels_move = false;
  std::vector<LabelledBox> decoys;  // what looks like a mover but stands
  // One for each frame where they are there (homographies.h, horizon.h).
  std::optional<std::vector<Eigen::Matrix3d>> first_from_frame;
  std::optional<std::vector<Eigen::Vector3d>> horizons;
  // What a reader has passed over, for people: one line each.
  std::vector<std::string> notes;

  // The boxes of the labels, for scoring.
  std::vector<LabelledBox> Truth() const;
};

// Reads the recording at `path`, telling its layout from what lies there:
//   a MOTChallenge folder (sequence.h) · a video, or a folder with one and no folders; beside it
//   NAME_groundtruth.txt with the target's box in each line, as UAV123 has it, or nothing · a
//   folder of numbered pictures · VisDrone VID and MOT: sequences/NAME · UAVDT MOT:
//   UAV-benchmark-M/M0101 · UAVDT SOT: UAV-benchmark-S/S0101 · UAV123: anno/SET/NAME.txt or
//   data_seq/SET/NAME · PESMOD: a folder with images/ and annotations/ · CDnet: a folder with
//   input/ and groundtruth/
// Throws FormatError where it is none of these, a frame is missing, or truth is malformed.
Recording OpenRecording(const std::filesystem::path& path);
// The same without truth, of which nothing is opened.
Recording OpenRecordingWithoutTruth(const std::filesystem::path& path);

// The recordings at and below `path`, by name: `path` itself where it is one. Empty where there are
// none. They are told by the files that are there; none is opened.
std::vector<std::filesystem::path> FindRecordings(const std::filesystem::path& path);

}  // namespace windhover::replay
