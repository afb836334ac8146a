// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "service/vision/types.h"

namespace windhover::replay {

// One box in one frame: truth, decoy or detection.
struct LabelledBox {
  int frame = 0;         // counts from 1
  std::int64_t id = -1;  // -1: no identity
  Box box;               // 0-based px, as everywhere in the program
  double score = 1.0;  // confidence of a detection; for truth 0 means "do not count" (MOTChallenge)
  double visible = 1.0;  // share of the object that is seen, 0 to 1; truth only
  int object_class = 1;  // MOTChallenge's number; 1 where nothing says
};

// MOTChallenge text: frame, id, left, top, width, height, score[, class[, visible[, ...]]], with
// 1-based pixels; `left` and `top` are shifted by one on the way in and out. Lines of detections
// may end after the score. Throws FormatError for the first malformed line.
std::vector<LabelledBox> ReadBoxes(const std::filesystem::path& file);

// gt.txt and static.txt: nine columns.
void WriteTruthBoxes(const std::filesystem::path& file, const std::vector<LabelledBox>& boxes);
// det.txt: ten columns as MOTChallenge has them, the last three -1.
void WriteDetections(const std::filesystem::path& file, const std::vector<LabelledBox>& boxes);

// det.txt, or where the name ends in .jsonl the lines of `windhover watch --json` for one stream;
// lines of other types than "detections" are passed over.
std::vector<LabelledBox> ReadDetections(const std::filesystem::path& file);

}  // namespace windhover::replay
