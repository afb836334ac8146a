// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/registration_results.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/thesis_results.h"
#include "replay/benchmarks/timing.h"
#include "replay/scoring/registration_score.h"
#include "service/vision/homography.h"

namespace windhover::replay {
namespace {

// A homography is known up to its factor: the one with which all that is seen lies in front.
Eigen::Matrix3d InFront(const Eigen::Matrix3d& matrix) {
  return matrix * std::copysign(1 / matrix.norm(), matrix.determinant());
}

std::optional<double> Mean(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// The means of the ten sequences; empty where one of them was not measured.
std::vector<double> TenMeans(const std::map<std::string, PairTally>& tallies) {
  std::vector<double> means;
  for (const std::string& id : TenSequences()) {
    const auto found = tallies.find(id);
    if (found == tallies.end() || !found->second.mean_px()) return {};
    means.push_back(*found->second.mean_px());
  }
  return means;
}

std::optional<double> TenFailures(const std::map<std::string, PairTally>& tallies) {
  if (TenMeans(tallies).empty()) return std::nullopt;
  int failures = 0;
  for (const std::string& id : TenSequences()) failures += tallies.at(id).failures();
  return failures;
}

ShareTally Pooled(const std::map<std::string, ShareTally>& tallies) {
  ShareTally all;
  for (const auto& [name, tally] : tallies) {
    all.of += tally.of;
    all.yes += tally.yes;
  }
  return all;
}

void AddContestantFigures(const RegistrationContestant& contestant, std::vector<Figure>& figures) {
  const std::string prefix =
      contestant.name.empty() ? "registration." : "peer." + contestant.name + ".";
  const std::vector<double> means = TenMeans(contestant.consecutive);
  AddFigure(figures, prefix + "rms_px.mean", Mean(means), "px");
  if (!means.empty()) {
    AddFigure(figures, prefix + "rms_px.max", *std::max_element(means.begin(), means.end()), "px");
  }
  std::vector<double> times_ms;
  for (const auto& [id, tally] : contestant.consecutive) {
    AddFigure(figures, prefix + "rms_px." + id, tally.mean_px(), "px");
    times_ms.insert(times_ms.end(), tally.times_ms.begin(), tally.times_ms.end());
  }
  AddFigure(figures, prefix + "failures", TenFailures(contestant.consecutive));
  AddFigure(figures, prefix + "gap10_rms_px.mean", Mean(TenMeans(contestant.ten_apart)), "px");
  for (const auto& [id, tally] : contestant.ten_apart) {
    AddFigure(figures, prefix + "gap10_rms_px." + id, tally.mean_px(), "px");
  }
  AddFigure(figures, prefix + "gap10_failures", TenFailures(contestant.ten_apart));
  AddFigure(figures, prefix + "reach_share", Pooled(contestant.reach).share());
  for (const auto& [stress, tally] : contestant.reach) {
    AddFigure(figures, prefix + "reach_share." + stress, tally.share());
  }
  if (!times_ms.empty()) {
    AddFigure(figures, prefix + "median_ms", Quantile(times_ms, 0.5), "ms");
    AddFigure(figures, prefix + "p95_ms", Quantile(times_ms, 0.95), "ms");
  }
}

}  // namespace

std::optional<double> PairRms(const std::optional<Eigen::Matrix3d>& measured,
                              const Eigen::Matrix3d& truth, int width, int height,
                              const GroundSeen& ground) {
  const std::optional<double> rms =
      RegistrationRms(InFront(measured.value_or(Eigen::Matrix3d::Identity())), InFront(truth),
                      width, height, ground);
  if (!rms) return std::nullopt;
  return std::min(*rms, std::hypot(width, height));
}

std::optional<double> PairTally::mean_px() const { return Mean(rms_px); }

int PairTally::failures() const {
  return static_cast<int>(
      std::count_if(rms_px.begin(), rms_px.end(), [](double rms) { return rms > kFailurePx; }));
}

std::optional<double> ShareTally::share() const {
  if (of == 0) return std::nullopt;
  return static_cast<double>(yes) / of;
}

std::optional<double> NormalisedCornerError(const FrameRegistration& registration,
                                            const Eigen::Matrix3d& truth, int width, int height) {
  const Eigen::Matrix3d& measured =
      registration.anchor_from_frame.value_or(registration.previous_from_frame);
  Eigen::Matrix<double, 8, 1> error;
  int row = 0;
  for (const Eigen::Vector2d& corner : PictureCorners(width, height)) {
    error.segment<2>(row) = Project(measured, corner) - Project(truth, corner);
    row += 2;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix8d> solver(registration.corner_covariance);
  const double largest = solver.eigenvalues().maxCoeff();
  if (!(largest > 0)) return std::nullopt;
  double sum = 0;
  int dimensions = 0;
  for (int i = 0; i < 8; ++i) {
    const double variance = solver.eigenvalues()(i);
    if (variance < 1e-12 * largest) continue;
    const double along = solver.eigenvectors().col(i).dot(error);
    sum += along * along / variance;
    ++dimensions;
  }
  return sum / dimensions;
}

std::optional<std::vector<std::string>> WindowsNoBetterThanNone(
    const RegistrationResults& results) {
  const auto mean_px = [&results](const ThesisWindow& window) -> std::optional<double> {
    const auto found = results.windows.find(window.name);
    if (found == results.windows.end()) return std::nullopt;
    return found->second.mean_px();
  };
  const std::optional<double> none_px = mean_px(kThesisWindows[0]);
  std::vector<std::string> worse;
  for (const ThesisWindow& window : kThesisWindows) {
    const std::optional<double> px = mean_px(window);
    if (!none_px || !px) return std::nullopt;
    if (window.window != WindowKind::kNone && *px >= *none_px) worse.emplace_back(window.name);
  }
  return worse;
}

std::vector<Figure> RegistrationFigures(const RegistrationResults& results) {
  std::vector<Figure> figures;
  for (const RegistrationContestant& contestant : results.contestants) {
    AddContestantFigures(contestant, figures);
  }
  AddFigure(figures, "registration.flagged_bad_share", Pooled(results.flagged_bad).share());
  AddFigure(figures, "registration.flagged_good_share", Pooled(results.flagged_good).share());
  if (const auto worse = WindowsNoBetterThanNone(results)) {
    AddFigure(figures, "registration.windows_no_better_than_none",
              static_cast<double>(worse->size()));
  }
  std::vector<double> all;
  for (const auto& [noise, errors] : results.corner_errors) {
    AddFigure(figures, "registration.nees_ratio.noise_" + std::to_string(noise), Mean(errors));
    all.insert(all.end(), errors.begin(), errors.end());
  }
  AddFigure(figures, "registration.nees_ratio", Mean(all));
  AddFigure(figures, "registration.first_frame_s.warm", results.first_frame.warm, "s");
  AddFigure(figures, "registration.first_frame_s.cold", results.first_frame.cold, "s");
  return figures;
}

}  // namespace windhover::replay
