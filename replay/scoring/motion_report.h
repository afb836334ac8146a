// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "replay/scoring/object_classes.h"
#include "replay/scoring/track_score.h"

namespace windhover::replay {

enum class MotionProtocol {
  // Boxes as they are.
  kWindhover,
  // As the scorer of PESMOD's author does (Delibasoglu, "UAV images dataset for moving object
  // detection from moving cameras", arXiv:2103.11460), as far as that holds for boxes: detections
  // of 10 px^2 and less and those that reach within 5 px of the picture's border are dropped, truth
  // is not; overlaps are 0.5 and 0.25; and the table's F1 is the mean of the sequences'. There
  // boxes
  // come from masks, by enlarging and merging contours; here they are given. Pairs are one to one
  // as everywhere here, so that a second detection of one object is a false alarm.
  kPesmod,
};

// Detections that the protocol looks at. `width` and `height` are the picture's, px.
std::vector<LabelledBox> ApplyProtocol(MotionProtocol protocol, std::vector<LabelledBox> detections,
                                       int width, int height);

// What a sequence's detections are held against.
struct MotionTruth {
  std::string name;
  std::vector<LabelledBox> boxes;
  int frames = 0;
  int width = 0;                        // px
  int height = 0;                       // px
  std::optional<double> frame_rate_hz;  // nothing where it is unknown
  // first_from_frame of each frame, or empty.
  std::vector<Eigen::Matrix3d> first_from_frame;
  // False where other things move unlabelled: then no false alarm can be told.
  bool complete = true;
};

// One sequence, or all of a dataset together.
struct MotionReport {
  struct AtOverlap {
    double least_overlap;
    MotionScore score;
  };

  std::string name;
  int frames = 0;
  bool complete = true;               // MotionTruth; for several: that all are
  std::vector<AtOverlap> at_overlap;  // as they were asked for
  MotionScore centre;                 // HitRule::ByCentre
  std::optional<TrackScore> tracks;   // the rest at the first overlap
  std::vector<ClassRecall> by_size;
  // Empty without homographies: then speed over the ground is unknown.
  std::vector<ClassRecall> by_speed;
  std::optional<double> minutes;  // nothing where the frame rate is unknown

  // Of the first overlap.
  const MotionScore& score() const { return at_overlap.front().score; }
  // Of the first overlap. Nothing without minutes or complete truth.
  std::optional<double> false_alarms_a_minute() const;
  double detections_a_frame() const;
};

// Overlaps that are reported where nothing else is asked for: thesis 6.6, and what the field takes.
std::vector<double> DefaultOverlaps(MotionProtocol protocol);

// Throws std::invalid_argument where there is no overlap or the truth has no frames.
MotionReport ReportMotion(const MotionTruth& truth, std::vector<LabelledBox> detections,
                          std::span<const double> overlaps,
                          MotionProtocol protocol = MotionProtocol::kWindhover);

// Counts of all sequences together: each box has the same weight. Tracks and minutes are absent
// where one sequence lacks them; recall by speed covers the sequences that have it. Throws
// std::invalid_argument for none and where the overlaps differ.
MotionReport Pool(std::span<const MotionReport> reports);

// Means over those sequences that have the figure: each sequence has the same weight. Precision and
// F1 are of those whose truth is complete.
struct MeanScore {
  std::optional<double> precision;
  std::optional<double> recall;
  std::optional<double> f1;
};
struct MotionMean {
  std::vector<MeanScore> at_overlap;  // in the order of the reports
  MeanScore centre;
  std::optional<double> false_alarms_a_minute;
};
// Of reports with the same overlaps; throws std::invalid_argument for none.
MotionMean MeanOf(std::span<const MotionReport> reports);

}  // namespace windhover::replay
