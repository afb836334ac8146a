// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "replay/benchmarks/figures.h"
#include "replay/scoring/registration_score.h"
#include "service/vision/types.h"

namespace windhover::replay {

// Below this a registration counts as good, px. Between this and kFailurePx it is neither good nor
// bad.
inline constexpr double kGoodPx = 0.5;

// The RMS in px of what was found for a pair of width x height px (RegistrationRms). Where nothing
// was found it is that of the identity, with which one has to go on; and it is the picture's
// diagonal at most, so that a mean over pairs stays a number. Nothing for pairs without common
// ground.
std::optional<double> PairRms(const std::optional<Eigen::Matrix3d>& measured,
                              const Eigen::Matrix3d& truth, int width, int height,
                              const GroundSeen& ground = {});

struct PairTally {
  std::vector<double> rms_px;
  std::vector<double> times_ms;  // of one frame each

  std::optional<double> mean_px() const;
  int failures() const;  // over kFailurePx
};

struct ShareTally {
  int of = 0;
  int yes = 0;

  void Add(bool is) {
    ++of;
    if (is) ++yes;
  }
  std::optional<double> share() const;
};

struct RegistrationContestant {
  std::string name;   // "" for the product, else as in figures
  std::string title;  // for people
  // By sequence.
  std::map<std::string, PairTally> consecutive;
  std::map<std::string, PairTally> ten_apart;
  std::map<std::string, ShareTally> reach;  // by stress: pairs under kGoodPx
};

struct FirstFrameSeconds {
  std::optional<double> warm;
  std::optional<double> cold;
};

// What `bench registration` has measured.
struct RegistrationResults {
  std::vector<RegistrationContestant> contestants;  // the product first
  // The product's consecutive frames by layout as in the thesis, then by sequence.
  std::map<std::string, std::map<std::string, PairTally>> layouts;
  std::map<std::string, PairTally> windows;  // by window as in the thesis, on sequence a4
  // Times of one frame by device, then by layout.
  std::map<std::string, std::map<std::string, std::vector<double>>> layout_times_ms;
  // Whether a pair was flagged (degraded or lost), by where it is from: those over kFailurePx or
  // without truth, and those under kGoodPx.
  std::map<std::string, ShareTally> flagged_bad;
  std::map<std::string, ShareTally> flagged_good;
  // Normalised squared errors of the corners over their expectation, by noise in grey levels.
  std::map<int, std::vector<double>> corner_errors;
  FirstFrameSeconds first_frame;
};

// The squared error of the frame's corners against truth, in units of the covariance, over its
// expectation, which is the number of dimensions that the covariance spans. 1 in the mean where the
// covariance is right. Nothing where the covariance is zero.
std::optional<double> NormalisedCornerError(const FrameRegistration& registration,
                                            const Eigen::Matrix3d& truth, int width, int height);

// The thesis' finding of table 2.3 is that any window beats none. These are the windows whose mean
// RMS is not smaller than without one; nothing where not all of them were measured.
std::optional<std::vector<std::string>> WindowsNoBetterThanNone(const RegistrationResults& results);

// Figures over the ten sequences are there only where all ten were measured.
std::vector<Figure> RegistrationFigures(const RegistrationResults& results);
std::vector<FigureTable> RegistrationTables(const RegistrationResults& results);
std::vector<FigurePlot> RegistrationPlots(const RegistrationResults& results);

}  // namespace windhover::replay
