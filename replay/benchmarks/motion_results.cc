// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/motion_results.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/thesis_results.h"

namespace windhover::replay {
namespace {

using Ratio = std::optional<double> (MotionScore::*)() const;

// Of each of the ten sequences, without those where it has nothing to divide by; empty where one of
// them was not measured.
std::vector<double> TenRatios(const MotionContestant& contestant, std::size_t overlap,
                              Ratio ratio) {
  std::vector<double> ratios;
  for (const std::string& id : TenSequences()) {
    const auto found = contestant.scores.find(id);
    if (found == contestant.scores.end()) return {};
    if (const std::optional<double> value = (found->second[overlap].*ratio)()) {
      ratios.push_back(*value);
    }
  }
  return ratios;
}

std::optional<double> Mean(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<double> Least(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return *std::min_element(values.begin(), values.end());
}

// All boxes of the ten sequences together.
std::optional<double> PooledF1(const MotionContestant& contestant, std::size_t overlap) {
  MotionScore all;
  for (const std::string& id : TenSequences()) {
    const auto found = contestant.scores.find(id);
    if (found == contestant.scores.end()) return std::nullopt;
    all.truth += found->second[overlap].truth;
    all.detections += found->second[overlap].detections;
    all.hits += found->second[overlap].hits;
  }
  return all.f1();
}

void AddContestantFigures(const MotionContestant& contestant, std::vector<Figure>& figures) {
  struct Kind {
    const char* name;
    Ratio ratio;
  };
  for (const Kind& kind :
       {Kind{"precision", &MotionScore::precision}, Kind{"recall", &MotionScore::recall}}) {
    const std::string name = contestant.prefix + kind.name;
    const std::vector<double> ratios = TenRatios(contestant, 0, kind.ratio);
    AddFigure(figures, name + ".mean", Mean(ratios));
    AddFigure(figures, name + ".min", Least(ratios));
    for (const auto& [id, scores] : contestant.scores) {
      AddFigure(figures, name + "." + id, (scores[0].*kind.ratio)());
    }
  }
  constexpr const char* kOverlapNames[kOverlaps.size()] = {"f1_005", "f1_025", "f1_05"};
  for (std::size_t i = 0; i < kOverlaps.size(); ++i) {
    AddFigure(figures, contestant.prefix + kOverlapNames[i] + ".pooled", PooledF1(contestant, i));
  }
  const auto interchange = contestant.scores.find("s1");
  if (interchange != contestant.scores.end()) {
    AddFigure(figures, contestant.prefix + "s1.f1_005", interchange->second[0].f1());
  }
}

TableCell PercentCell(std::optional<double> share) {
  if (!share) return {};
  return 100 * *share;
}

// Of the ten, as figures have it.
void AddMeanRow(const MotionResults& results, FigureTable& table) {
  if (TenRatios(results.contestants[MotionResults::kAnchor], 0, &MotionScore::recall).empty()) {
    return;
  }
  std::vector<TableCell>& row = table.rows.emplace_back();
  row.emplace_back("mean of the ten");
  for (const auto& thesis : {kThesisFrameDifferencing, kThesisFiltering}) {
    ThesisMotion sum = {0, 0};
    for (const ThesisMotion& one : thesis) {
      sum.precision += one.precision;
      sum.recall += one.recall;
    }
    row.emplace_back(sum.precision / static_cast<double>(thesis.size()));
    row.emplace_back(sum.recall / static_cast<double>(thesis.size()));
  }
  for (const MotionContestant& one : results.contestants) {
    row.push_back(PercentCell(Mean(TenRatios(one, 0, &MotionScore::precision))));
    row.push_back(PercentCell(Mean(TenRatios(one, 0, &MotionScore::recall))));
  }
}

// Precision and recall in percent at kThesisOverlap, the thesis' beside ours.
FigureTable PrecisionRecallTable(const MotionResults& results) {
  FigureTable table = {.name = "motion.table_6_1",
                       .title = "Table 6.1: precision and recall in % at overlap 5 %",
                       .columns = {"sequence", "thesis FD P", "R", "thesis P", "R"},
                       .rows = {},
                       .digits = 1};
  for (const MotionContestant& one : results.contestants) {
    table.columns.push_back(one.title + " P");
    table.columns.emplace_back("R");
  }
  for (const auto& [id, scores] : results.contestants[MotionResults::kAnchor].scores) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.emplace_back(id);
    if (const std::optional<int> index = ThesisSequence(id)) {
      for (const ThesisMotion& thesis :
           {kThesisFrameDifferencing[*index], kThesisFiltering[*index]}) {
        row.emplace_back(thesis.precision);
        row.emplace_back(thesis.recall);
      }
    } else {
      row.resize(row.size() + 4);
    }
    for (const MotionContestant& one : results.contestants) {
      const MotionScore& score = one.scores.at(id)[0];
      row.push_back(PercentCell(score.precision()));
      row.push_back(PercentCell(score.recall()));
    }
  }
  AddMeanRow(results, table);
  return table;
}

FigureTable OverlapTable(const MotionResults& results) {
  FigureTable table = {.name = "motion.f1",
                       .title = "F1 in % at overlap 5 %, 25 % and 50 %",
                       .columns = {"sequence"},
                       .rows = {},
                       .digits = 1};
  for (const MotionContestant& one : results.contestants) {
    table.columns.insert(table.columns.end(), {one.title + " 5", "25", "50"});
  }
  for (const auto& [id, scores] : results.contestants[MotionResults::kAnchor].scores) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.emplace_back(id);
    for (const MotionContestant& one : results.contestants) {
      for (const MotionScore& score : one.scores.at(id)) row.push_back(PercentCell(score.f1()));
    }
  }
  return table;
}

FigureTable CurveTable(const MotionResults& results) {
  FigureTable table = {.name = "motion.figure_6_7",
                       .title =
                           "Figure 6.7: frame differencing on sequence 4 by least area of a "
                           "component and by threshold in grey levels, in %",
                       .columns = {"least area px"},
                       .rows = {},
                       .digits = 1};
  const auto curve = results.curves.find("04");
  if (curve == results.curves.end()) return table;
  std::map<int, std::vector<TableCell>> rows;
  for (const CurvePoint& point : curve->second) {
    std::vector<TableCell>& row = rows[point.min_area_px];
    if (row.empty()) row.emplace_back(point.min_area_px);
    row.push_back(PercentCell(point.score.precision()));
    row.push_back(PercentCell(point.score.recall()));
    if (point.min_area_px == curve->second.front().min_area_px) {
      table.columns.push_back("P at " + std::to_string(point.threshold));
      table.columns.emplace_back("R");
    }
  }
  for (auto& [area, row] : rows) table.rows.push_back(std::move(row));
  return table;
}

FigureTable RealTable(const MotionResults& results) {
  FigureTable table = {
      .name = "motion.real",
      .title =
          "Real video: boxes a frame, or false alarms where nothing moves; recall "
          "of the labelled object in % at overlap 5 %, 25 % and 50 %",
      .columns = {"set", "frames", "boxes a frame", "false alarms a frame", "recall 5", "25", "50"},
      .rows = {},
      .digits = 2};
  for (const RealSetResult& real : results.real) {
    std::vector<TableCell>& row = table.rows.emplace_back();
    row.emplace_back(real.name);
    row.emplace_back(real.frames);
    row.resize(4);
    row[real.still ? 3 : 2] = static_cast<double>(real.boxes) / real.frames;
    for (const double recall : real.recall) row.emplace_back(100 * recall);
    row.resize(table.columns.size());
  }
  return table;
}

}  // namespace

std::vector<Figure> MotionFigures(const MotionResults& results) {
  std::vector<Figure> figures;
  for (const MotionContestant& one : results.contestants) AddContestantFigures(one, figures);
  const std::optional<double> anchor =
      Mean(TenRatios(results.contestants[MotionResults::kAnchor], 0, &MotionScore::f1));
  const std::optional<double> centre =
      Mean(TenRatios(results.contestants[MotionResults::kCentre], 0, &MotionScore::f1));
  if (anchor && centre) AddFigure(figures, "motion.centre_minus_anchor", *centre - *anchor);
  constexpr const char* kOverlapNames[kOverlaps.size()] = {"recall_005", "recall_025", "recall_05"};
  for (const RealSetResult& real : results.real) {
    const std::string prefix = "motion.real." + real.name + ".";
    AddFigure(figures, prefix + (real.still ? "false_alarms_per_frame" : "boxes_per_frame"),
              static_cast<double>(real.boxes) / real.frames);
    for (std::size_t i = 0; i < real.recall.size(); ++i) {
      AddFigure(figures, prefix + kOverlapNames[i], real.recall[i]);
    }
  }
  return figures;
}

std::vector<std::string> UndefinedRatios(const MotionResults& results) {
  std::vector<std::string> lines;
  for (const MotionContestant& one : results.contestants) {
    for (const auto& [id, scores] : one.scores) {
      if (!scores[0].precision()) {
        lines.push_back(one.prefix + "precision." + id + ": nothing was detected");
      }
      if (!scores[0].recall()) lines.push_back(one.prefix + "recall." + id + ": nothing moves");
    }
  }
  return lines;
}

std::vector<FigureTable> MotionTables(const MotionResults& results) {
  std::vector<FigureTable> tables;
  for (FigureTable& table : std::array{PrecisionRecallTable(results), CurveTable(results),
                                       OverlapTable(results), RealTable(results)}) {
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace windhover::replay
