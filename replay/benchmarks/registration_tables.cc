// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "replay/benchmarks/registration_results.h"
#include "replay/benchmarks/thesis_results.h"
#include "replay/benchmarks/timing.h"

// The tables of `bench registration` (declared in registration_results.h).

namespace windhover::replay {
namespace {

using Tallies = std::map<std::string, PairTally>;

TableCell MeanCell(const Tallies& tallies, const std::string& id) {
  const auto found = tallies.find(id);
  if (found == tallies.end()) return {};
  return CellOf(found->second.mean_px());
}

PairTally Pooled(const Tallies& tallies) {
  PairTally all;
  for (const auto& [id, tally] : tallies) {
    all.rms_px.insert(all.rms_px.end(), tally.rms_px.begin(), tally.rms_px.end());
    all.times_ms.insert(all.times_ms.end(), tally.times_ms.begin(), tally.times_ms.end());
  }
  return all;
}

TableCell QuantileCell(const std::vector<double>& samples, double share) {
  if (samples.empty()) return {};
  return Quantile(samples, share);
}

TableCell PercentCell(std::optional<double> share) {
  if (!share) return {};
  return 100 * *share;
}

TableCell FailureCell(const PairTally& tally) {
  if (tally.rms_px.empty()) return {};
  return 100.0 * tally.failures() / static_cast<double>(tally.rms_px.size());
}

FigureTable ContestantTable(const RegistrationResults& results) {
  FigureTable table = {
      .name = "registration.contestants",
      .title = "Registration of consecutive frames, over all pairs measured",
      .columns = {"", "pairs", "RMS mean px", "median px", "over 2 px %", "10 apart mean px",
                  "median px", "over 2 px %", "median ms", "p95 ms"},
      .rows = {},
      .digits = 3};
  for (const RegistrationContestant& one : results.contestants) {
    const PairTally near = Pooled(one.consecutive);
    const PairTally far = Pooled(one.ten_apart);
    table.rows.push_back({one.title, static_cast<int>(near.rms_px.size()), CellOf(near.mean_px()),
                          QuantileCell(near.rms_px, 0.5), FailureCell(near), CellOf(far.mean_px()),
                          QuantileCell(far.rms_px, 0.5), FailureCell(far),
                          QuantileCell(near.times_ms, 0.5), QuantileCell(near.times_ms, 0.95)});
  }
  return table;
}

// Mean RMS by sequence, a column for each contestant.
FigureTable SequenceTable(const RegistrationResults& results, std::string name, std::string title,
                          Tallies RegistrationContestant::*tallies) {
  FigureTable table = {std::move(name), std::move(title), {"sequence"}, {}, 3, true};
  std::set<std::string> ids;
  for (const RegistrationContestant& one : results.contestants) {
    table.columns.push_back(one.title);
    for (const auto& [id, tally] : one.*tallies) ids.insert(id);
  }
  for (const std::string& id : ids) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.emplace_back(id);
    for (const RegistrationContestant& one : results.contestants) {
      row.push_back(MeanCell(one.*tallies, id));
    }
  }
  return table;
}

FigureTable LayoutTable(const RegistrationResults& results) {
  FigureTable table = {.name = "registration.table_2_2",
                       .title = "Table 2.2: RMS in px by number of tiles",
                       .columns = {"sequence", "of"},
                       .rows = {},
                       .digits = 3,
                       .least_is_best = true};
  std::set<std::string> ids;
  for (const auto& [name, tallies] : results.layouts) {
    for (const auto& [id, tally] : tallies) ids.insert(id);
  }
  for (const ThesisLayout& layout : kThesisLayouts) table.columns.emplace_back(layout.name);
  for (const std::string& id : ids) {
    std::vector<TableCell> ours = {id, "windhover"};
    std::vector<TableCell> thesis = {id, "thesis"};
    const std::optional<int> index = ThesisSequence(id);
    for (const ThesisLayout& layout : kThesisLayouts) {
      const auto found = results.layouts.find(layout.name);
      ours.push_back(found == results.layouts.end() ? TableCell() : MeanCell(found->second, id));
      if (index) thesis.emplace_back(layout.rms_px[*index]);
    }
    table.rows.push_back(std::move(ours));
    if (index) table.rows.push_back(std::move(thesis));
  }
  return table;
}

// Whether the thesis' finding holds.
std::string WindowFinding(const RegistrationResults& results) {
  const auto worse = WindowsNoBetterThanNone(results);
  if (!worse) return "";
  if (worse->empty()) return "; each beats none, as in the thesis";
  std::string finding = "; no better than none, unlike in the thesis:";
  for (const std::string& window : *worse) finding += ' ' + window + ';';
  finding.pop_back();
  return finding;
}

FigureTable WindowTable(const RegistrationResults& results) {
  FigureTable table = {.name = "registration.table_2_3",
                       .title = "Table 2.3: mean RMS in px by window function, on sequence a4" +
                                WindowFinding(results),
                       .columns = {"window", "windhover", "thesis"},
                       .rows = {},
                       .digits = 3};
  if (results.windows.empty()) return table;
  for (const ThesisWindow& window : kThesisWindows) {
    const auto found = results.windows.find(window.name);
    table.rows.push_back(
        {window.name,
         found == results.windows.end() ? TableCell() : CellOf(found->second.mean_px()),
         window.rms_px});
  }
  return table;
}

FigureTable LayoutTimeTable(const RegistrationResults& results) {
  FigureTable table = {.name = "registration.figure_2_7",
                       .title = "Figure 2.7: time of a frame in ms by number of tiles, on a1 to a4",
                       .columns = {"tiles"},
                       .rows = {},
                       .digits = 2};
  for (const auto& [device, times] : results.layout_times_ms) {
    table.columns.push_back(device + " median");
    table.columns.emplace_back("p95");
  }
  if (results.layout_times_ms.empty()) return table;
  for (const ThesisLayout& layout : kThesisLayouts) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.emplace_back(layout.name);
    for (const auto& [device, times] : results.layout_times_ms) {
      const auto found = times.find(layout.name);
      for (const double share : {0.5, 0.95}) {
        row.push_back(found == times.end() ? TableCell() : QuantileCell(found->second, share));
      }
    }
  }
  return table;
}

FigureTable ReachTable(const RegistrationResults& results) {
  FigureTable table = {.name = "registration.reach",
                       .title = "Reach: percent of cut pairs within 0.5 px",
                       .columns = {"stress", "pairs"},
                       .rows = {},
                       .digits = 1};
  for (const RegistrationContestant& one : results.contestants) table.columns.push_back(one.title);
  for (const auto& [stress, ours] : results.contestants.front().reach) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row = {stress, ours.of};
    for (const RegistrationContestant& one : results.contestants) {
      const auto found = one.reach.find(stress);
      row.push_back(PercentCell(found == one.reach.end() ? std::nullopt : found->second.share()));
    }
  }
  return table;
}

FigureTable HonestyTable(const RegistrationResults& results) {
  FigureTable table = {
      .name = "registration.honesty",
      .title = "Honesty: percent of pairs flagged degraded or lost",
      .columns = {"pairs from", "over 2 px", "flagged %", "under 0.5 px", "flagged %"},
      .rows = {},
      .digits = 2};
  std::set<std::string> places;
  for (const auto& [place, tally] : results.flagged_bad) places.insert(place);
  for (const auto& [place, tally] : results.flagged_good) places.insert(place);
  for (const std::string& place : places) {
    const auto tally_of = [&](const std::map<std::string, ShareTally>& tallies) {
      const auto found = tallies.find(place);
      return found == tallies.end() ? ShareTally() : found->second;
    };
    const ShareTally bad = tally_of(results.flagged_bad);
    const ShareTally good = tally_of(results.flagged_good);
    table.rows.push_back(
        {place, bad.of, PercentCell(bad.share()), good.of, PercentCell(good.share())});
  }
  return table;
}

}  // namespace

std::vector<FigureTable> RegistrationTables(const RegistrationResults& results) {
  std::vector<FigureTable> tables;
  const auto keep = [&tables](FigureTable table) {
    if (!table.rows.empty()) tables.push_back(std::move(table));
  };
  if (results.contestants.empty()) return tables;
  keep(LayoutTable(results));
  keep(WindowTable(results));
  keep(LayoutTimeTable(results));
  keep(ContestantTable(results));
  keep(SequenceTable(results, "registration.rms_by_sequence",
                     "Mean RMS in px, consecutive frames (slow peers: every tenth pair)",
                     &RegistrationContestant::consecutive));
  keep(SequenceTable(results, "registration.gap10_by_sequence", "Mean RMS in px, frames ten apart",
                     &RegistrationContestant::ten_apart));
  keep(ReachTable(results));
  keep(HonestyTable(results));
  return tables;
}

}  // namespace windhover::replay
