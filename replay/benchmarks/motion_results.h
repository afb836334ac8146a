// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "replay/benchmarks/figures.h"
#include "replay/scoring/motion_score.h"

namespace windhover::replay {

// Intersection over union that a hit exceeds.
inline constexpr std::array<double, 3> kOverlaps = {kThesisOverlap, 0.25, 0.5};
using OverlapScores = std::array<MotionScore, kOverlaps.size()>;

struct MotionContestant {
  std::string prefix;                           // of its figures' names
  std::string title;                            // for people
  std::map<std::string, OverlapScores> scores;  // by sequence
};

// Frame differencing with one threshold and one size filter (figure 6.7).
struct CurvePoint {
  int threshold = 0;    // grey levels
  int min_area_px = 0;  // of a component
  MotionScore score;    // at kThesisOverlap
};

// On a real recording of which one object is labelled, or nothing that moves.
struct RealSetResult {
  std::string name;
  int frames = 0;
  int boxes = 0;       // detections in all frames
  bool still = false;  // nothing moves: every detection is a false alarm
  // Of the labelled object, at each of kOverlaps; empty where there is none.
  std::vector<double> recall;
};

// What `bench motion` has measured.
struct MotionResults {
  static constexpr std::size_t kAnchor = 0;  // the product by default
  static constexpr std::size_t kCentre = 1;
  static constexpr std::size_t kFrameDifferencing = 2;
  std::vector<MotionContestant> contestants;              // these three, then other peers
  std::map<std::string, std::vector<CurvePoint>> curves;  // by sequence
  std::vector<SampleFrame> samples;
  std::vector<RealSetResult> real;
};

// Figures over the ten sequences are there only where all ten were measured.
std::vector<Figure> MotionFigures(const MotionResults& results);
// A line for each precision and recall of a sequence that has nothing to divide by.
std::vector<std::string> UndefinedRatios(const MotionResults& results);
std::vector<FigureTable> MotionTables(const MotionResults& results);
std::vector<FigurePlot> MotionPlots(const MotionResults& results);

}  // namespace windhover::replay
