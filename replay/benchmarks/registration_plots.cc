// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "replay/benchmarks/registration_results.h"
#include "replay/benchmarks/thesis_results.h"
#include "replay/benchmarks/timing.h"

// The plots of `bench registration` (declared in registration_results.h).

namespace windhover::replay {
namespace {

using Tallies = std::map<std::string, PairTally>;

constexpr std::string_view kDefaultLayout = "36";  // RegistrationOptions: 6 by 6

std::optional<double> ThesisRms(const std::string& id) {
  const std::optional<int> index = ThesisSequence(id);
  if (!index) return std::nullopt;
  const auto* layout =
      std::find_if(std::begin(kThesisLayouts), std::end(kThesisLayouts),
                   [](const ThesisLayout& one) { return kDefaultLayout == one.name; });
  return layout->rms_px[*index];
}

// Mean RMS by sequence, a series for each contestant.
FigurePlot SequencePlot(const RegistrationResults& results, std::string name, std::string title,
                        Tallies RegistrationContestant::*tallies) {
  FigurePlot plot = {.name = std::move(name),
                     .title = std::move(title),
                     .x = {"sequence", false, {}, {}},
                     .y = {"mean RMS, px", true, {}, {}},
                     .panels = {{}}};
  std::vector<std::string>& ids = plot.x.categories;
  for (const auto& [id, tally] : results.contestants.front().*tallies) ids.push_back(id);
  for (const RegistrationContestant& one : results.contestants) {
    PlotSeries& series = plot.panels.front().series.emplace_back();
    series.name = one.title;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto found = (one.*tallies).find(ids[i]);
      if (found == (one.*tallies).end() || !found->second.mean_px()) continue;
      series.points.push_back({static_cast<double>(i), *found->second.mean_px(), {}});
    }
  }
  return plot;
}

FigurePlot LayoutTimePlot(const RegistrationResults& results) {
  FigurePlot plot = {.name = "registration.figure_2_7",
                     .title =
                         "Figure 2.7: time of a frame by number of tiles, on a1 to a4: median, "
                         "and a whisker to the 95th percentile",
                     .x = {"tiles", false, {}, {}},
                     .y = {"time of a frame, ms", false, {}, {}},
                     .panels = {{}}};
  for (const ThesisLayout& layout : kThesisLayouts) {
    plot.x.categories.emplace_back(layout.name);
  }
  for (const auto& [device, times] : results.layout_times_ms) {
    PlotSeries& series = plot.panels.front().series.emplace_back();
    series = {device, true, {}};
    for (std::size_t i = 0; i < plot.x.categories.size(); ++i) {
      const auto found = times.find(plot.x.categories[i]);
      if (found == times.end() || found->second.empty()) continue;
      series.points.push_back(
          {static_cast<double>(i), Quantile(found->second, 0.5), Quantile(found->second, 0.95)});
    }
  }
  return plot;
}

}  // namespace

std::vector<FigurePlot> RegistrationPlots(const RegistrationResults& results) {
  std::vector<FigurePlot> plots;
  if (results.contestants.empty()) return plots;
  FigurePlot near = SequencePlot(results, "registration.rms_by_sequence",
                                 "Mean RMS by sequence, consecutive frames (slow peers: every "
                                 "tenth pair); the thesis' with as many tiles",
                                 &RegistrationContestant::consecutive);
  PlotSeries thesis = {"thesis", false, {}};
  for (std::size_t i = 0; i < near.x.categories.size(); ++i) {
    const std::optional<double> rms = ThesisRms(near.x.categories[i]);
    if (rms) thesis.points.push_back({static_cast<double>(i), *rms, {}});
  }
  if (!thesis.points.empty()) near.panels.front().series.push_back(std::move(thesis));
  plots.push_back(std::move(near));
  plots.push_back(SequencePlot(results, "registration.gap10_by_sequence",
                               "Mean RMS by sequence, frames ten apart",
                               &RegistrationContestant::ten_apart));
  if (!results.layout_times_ms.empty()) plots.push_back(LayoutTimePlot(results));
  std::erase_if(plots, [](const FigurePlot& plot) { return plot.x.categories.empty(); });
  return plots;
}

}  // namespace windhover::replay
