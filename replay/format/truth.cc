// SPDX-License-Identifier: Apache-2.0
#include "replay/format/truth.h"

#include <string>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/format/horizon.h"

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
  const std::filesystem::path file = HomographiesPath(sequence_);
  std::vector<Eigen::Matrix3d> homographies = ReadHomographies(file);
  CheckNumber(file, homographies.size());
  homographies.resize(frames_);
  return homographies;
}

std::vector<Eigen::Vector3d> SequenceTruth::Horizons() const {
  const std::filesystem::path file = HorizonPath(sequence_);
  if (!std::filesystem::exists(file)) return {};
  std::vector<Eigen::Vector3d> horizons = ReadHorizons(file);
  CheckNumber(file, horizons.size());
  horizons.resize(frames_);
  return horizons;
}

void SequenceTruth::CheckNumber(const std::filesystem::path& file, std::size_t frames) const {
  if (frames == static_cast<std::size_t>(info_.frames)) return;
  throw FormatError(file, "is of " + std::to_string(frames) +
                              " frames, but seqinfo.ini says that there are " +
                              std::to_string(info_.frames));
}

}  // namespace windhover::replay
