// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "replay/readers/recording.h"
#include "replay/scoring/motion_report.h"

namespace windhover::replay {

// A recording's truth and the file of what was measured on it.
struct ScoredPair {
  std::string name;
  std::filesystem::path truth;
  std::filesystem::path measured;
};

// The one pair where `truth` is a recording and `measured` a file. Where `truth` holds recordings
// (DIR/01 ... DIR/10), those and below the folder `measured` the files that are called alike
// (01/det.txt ...). Throws FormatError where neither is so.
std::vector<ScoredPair> PairUp(const std::filesystem::path& truth,
                               const std::filesystem::path& measured, const std::string& file_name);

// What OpenRecording reads, of the first frames only where `frames` is not 0. Throws FormatError
// where it has fewer, or where neither says how many there are.
Recording OpenTruth(const std::filesystem::path& path, int frames);

// Homographies of as many frames as the recording has, or of more where only `frames` of them are
// asked for. Throws FormatError.
std::vector<Eigen::Matrix3d> ReadMeasuredHomographies(const std::filesystem::path& file,
                                                      const Recording& truth, int frames);

// Where objects are labelled whether they move or stand, those that stand are made not to count, by
// the recording's homographies or, where it has none, by those in `homographies` (may be empty).
// Throws FormatError where such are needed and neither is there, and where nothing is labelled.
MotionTruth MotionTruthOf(const ScoredPair& pair, const std::filesystem::path& homographies,
                          int frames);

// Throws FormatError for a box in a frame that the truth does not have; those past `frames` are
// left out where that is not 0.
std::vector<LabelledBox> ReadMeasuredDetections(const ScoredPair& pair, const MotionTruth& truth,
                                                int frames);

}  // namespace windhover::replay
