// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "replay/benchmarks/motion_results.h"
#include "replay/benchmarks/thesis_results.h"

// The plots of `bench motion` (declared in motion_results.h).

namespace windhover::replay {
namespace {

// Recall and precision in percent. Without the point where either has nothing to divide by.
void AddPoint(const MotionScore& score, PlotSeries& series) {
  const std::optional<double> precision = score.precision();
  const std::optional<double> recall = score.recall();
  if (precision && recall) series.points.push_back({100 * *recall, 100 * *precision, {}});
}

std::vector<PlotSeries> CurvesOf(const std::vector<CurvePoint>& curve) {
  std::vector<PlotSeries> series;
  for (const CurvePoint& point : curve) {
    const std::string name = "FD, threshold " + std::to_string(point.threshold);
    if (series.empty() || series.back().name != name) series.push_back({name, true, {}});
    AddPoint(point.score, series.back());
  }
  return series;
}

FigurePlot PrecisionRecallPlot(const MotionResults& results) {
  FigurePlot plot = {.name = "motion.figure_6_7",
                     .title =
                         "Figure 6.7, for each sequence: precision over recall at overlap 5 %. "
                         "Curves: frame differencing by least area of a component",
                     .x = {"recall, %", false, {}, {{0, 100}}},
                     .y = {"precision, %", false, {}, {{0, 100}}},
                     .panels = {}};
  for (const auto& [id, scores] : results.contestants[MotionResults::kAnchor].scores) {
    FigurePlot::Panel& panel = plot.panels.emplace_back();
    panel.title = "sequence " + id;
    const auto curve = results.curves.find(id);
    if (curve != results.curves.end()) panel.series = CurvesOf(curve->second);
    for (const MotionContestant& one : results.contestants) {
      PlotSeries& series = panel.series.emplace_back();
      series.name = one.title;
      AddPoint(one.scores.at(id)[0], series);
    }
    if (const std::optional<int> index = ThesisSequence(id)) {
      const ThesisMotion& filtering = kThesisFiltering[*index];
      const ThesisMotion& differencing = kThesisFrameDifferencing[*index];
      panel.series.push_back({"thesis", false, {{filtering.recall, filtering.precision, {}}}});
      panel.series.push_back(
          {"thesis FD", false, {{differencing.recall, differencing.precision, {}}}});
    }
  }
  return plot;
}

FigurePlot OverlapPlot(const MotionResults& results) {
  FigurePlot plot = {.name = "motion.f1",
                     .title = "F1 by the overlap that a hit must exceed",
                     .x = {"overlap, %", false, {"5", "25", "50"}, {}},
                     .y = {"F1, %", false, {}, {{0, 100}}},
                     .panels = {}};
  for (const auto& [id, scores] : results.contestants[MotionResults::kAnchor].scores) {
    FigurePlot::Panel& panel = plot.panels.emplace_back();
    panel.title = "sequence " + id;
    for (const MotionContestant& one : results.contestants) {
      PlotSeries& series = panel.series.emplace_back();
      series = {one.title, true, {}};
      for (std::size_t i = 0; i < kOverlaps.size(); ++i) {
        const std::optional<double> f1 = one.scores.at(id)[i].f1();
        if (f1) series.points.push_back({static_cast<double>(i), 100 * *f1, {}});
      }
    }
  }
  return plot;
}

}  // namespace

std::vector<FigurePlot> MotionPlots(const MotionResults& results) {
  if (results.contestants[MotionResults::kAnchor].scores.empty()) return {};
  return {PrecisionRecallPlot(results), OverlapPlot(results)};
}

}  // namespace windhover::replay
