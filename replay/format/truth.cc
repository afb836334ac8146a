// SPDX-License-Identifier: Apache-2.0
#include "replay/format/truth.h"

#include <string>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/homographies.h"

namespace windhover::replay {

SequenceTruth::SequenceTruth(std::filesystem::path sequence, int frames)
    : sequence_(std::move(sequence)),
      info_(ReadSequenceInfo(sequence_)),
      frames_(frames > 0 ? frames : info_.frames) {
  if (frames_ > info_.frames) {
    throw FormatError(sequence_, "has " + std::to_string(info_.frames) + " frames, but " +
                                     std::to_string(frames_) + " are asked for");
  }
}

std::vector<LabelledBox> SequenceTruth::Movers() const {
  std::vector<LabelledBox> movers = ReadBoxes(MoversPath(sequence_));
  for (const LabelledBox& box : movers) {
    if (box.frame > info_.frames) {
      throw FormatError(MoversPath(sequence_), "has a box in frame " + std::to_string(box.frame) +
                                                   ", but seqinfo.ini says that there are " +
                                                   std::to_string(info_.frames));
    }
  }
  std::erase_if(movers, [this](const LabelledBox& box) { return box.frame > frames_; });
  return movers;
}

bool SequenceTruth::HasHomographies() const {
  return std::filesystem::exists(HomographiesPath(sequence_));
}

std::vector<Eigen::Matrix3d> SequenceTruth::Homographies() const {
  std::vector<Eigen::Matrix3d> homographies = ReadHomographies(HomographiesPath(sequence_));
  if (homographies.size() != static_cast<std::size_t>(info_.frames)) {
    throw FormatError(HomographiesPath(sequence_),
                      "is of " + std::to_string(homographies.size()) +
                          " frames, but seqinfo.ini says that there are " +
                          std::to_string(info_.frames));
  }
  homographies.resize(frames_);
  return homographies;
}

}  // namespace windhover::replay
