// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "replay/format/labels.h"
#include "replay/format/sequence.h"

namespace windhover::replay {

// The truth of a sequence, or of its first frames where that is asked for: never of fewer because
// something else is short.
class SequenceTruth {
 public:
  // `frames` from 1: only so many from the start; 0: all. Reads seqinfo.ini. Throws FormatError
  // where it is malformed or the sequence has fewer frames.
  SequenceTruth(std::filesystem::path sequence, int frames);

  int frames() const { return frames_; }
  int width() const { return info_.width; }    // px
  int height() const { return info_.height; }  // px
  double frame_rate_hz() const { return info_.frame_rate_hz; }

  // Boxes of what moves. Throws FormatError for malformed lines and frames that the sequence lacks.
  std::vector<LabelledBox> Movers() const;
  // Not every sequence has them.
  bool HasHomographies() const;
  // first_from_frame of each frame. Throws FormatError where they are malformed or not as many as
  // the sequence has frames.
  std::vector<Eigen::Matrix3d> Homographies() const;
  // Of each frame as in horizon.h; empty where the sequence shows no sky. Throws FormatError as
  // Homographies does.
  std::vector<Eigen::Vector3d> Horizons() const;

 private:
  void CheckNumber(const std::filesystem::path& file, std::size_t frames) const;

  std::filesystem::path sequence_;
  SequenceInfo info_;
  int frames_;
};

}  // namespace windhover::replay
