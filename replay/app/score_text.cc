// SPDX-License-Identifier: Apache-2.0
#include "replay/app/score_text.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace windhover::replay {
namespace {

std::string Number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string Percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f} %", 100 * *share) : "-";
}

std::string Pixels(const std::optional<double>& distance) {
  return distance ? fmt::format("{:.4f} px", *distance) : "-";
}

// What cannot be told where other things move unlabelled.
std::optional<double> IfComplete(const MotionReport& report, const std::optional<double>& value) {
  return report.complete ? value : std::nullopt;
}

std::string OverlapName(double overlap) { return fmt::format("overlap {}", overlap); }

std::string ScoreLine(const std::string& rule, const MotionReport& report,
                      const MotionScore& score) {
  return fmt::format("  {:<14}{:>10}{:>10}{:>10}{:>9}\n", rule,
                     Percent(IfComplete(report, score.precision())), Percent(score.recall()),
                     Percent(IfComplete(report, score.f1())), score.hits);
}

std::string ClassLine(const std::string& title, std::span<const ClassRecall> classes) {
  std::string text = "  " + title;
  for (const ClassRecall& one : classes) {
    const std::string bounds = one.below ? fmt::format("{} to {}", one.least, *one.below)
                                         : fmt::format("from {}", one.least);
    text += fmt::format("{} {}: {} of {}", text.back() == ':' ? "" : ";", bounds,
                        Percent(one.recall()), one.truth);
  }
  return text + "\n";
}

// One line of a table: the first cell to the left, the others to the right.
std::string Row(const std::vector<std::string>& cells, std::size_t name_width) {
  std::string text = fmt::format("{:<{}}", cells.front(), name_width);
  for (std::size_t i = 1; i < cells.size(); ++i) text += fmt::format("{:>10}", cells[i]);
  return text + "\n";
}

template <typename Named>
std::size_t NameWidth(std::span<const Named> all) {
  std::size_t width = std::string("sequence").size();
  for (const Named& one : all) width = std::max(width, one.name.size());
  return width + 1;
}

std::vector<std::string> MotionCells(const MotionReport& report) {
  std::vector<std::string> cells = {report.name,
                                    std::to_string(report.frames),
                                    std::to_string(report.score().truth),
                                    std::to_string(report.score().detections),
                                    Percent(IfComplete(report, report.score().precision())),
                                    Percent(report.score().recall())};
  for (const MotionReport::AtOverlap& one : report.at_overlap) {
    cells.push_back(Percent(IfComplete(report, one.score.f1())));
  }
  cells.push_back(Percent(IfComplete(report, report.centre.f1())));
  cells.push_back(Number(report.false_alarms_a_minute(), 1));
  cells.push_back(report.tracks ? std::to_string(report.tracks->id_switches) : "-");
  cells.push_back(report.tracks ? std::to_string(report.tracks->fragmentations) : "-");
  return cells;
}

std::vector<std::string> MeanCells(const MotionMean& mean) {
  std::vector<std::string> cells = {"mean",
                                    "",
                                    "",
                                    "",
                                    Percent(mean.at_overlap.front().precision),
                                    Percent(mean.at_overlap.front().recall)};
  for (const MeanScore& one : mean.at_overlap) cells.push_back(Percent(one.f1));
  cells.push_back(Percent(mean.centre.f1));
  cells.push_back(Number(mean.false_alarms_a_minute, 1));
  cells.insert(cells.end(), {"", ""});
  return cells;
}

std::string ResidualText(const std::string& title, const ResidualSummary& summary) {
  std::string text = fmt::format(
      "  {}: {} pairs, residual {} grey levels warped, {} unwarped, {} from noise; about {} off "
      "(medians over pairs)",
      title, summary.warped.count, Number(summary.warped.median, 2),
      Number(summary.unwarped.median, 2), Number(summary.noise.median, 2),
      summary.misplacement_px.median ? fmt::format("{:.3f} px", *summary.misplacement_px.median)
                                     : "-");
  if (summary.without_common > 0) {
    text += fmt::format("; {} pairs have too little in common", summary.without_common);
  }
  return text + "\n";
}

}  // namespace

std::string Describe(const MotionReport& report) {
  std::string text = fmt::format(
      "motion: {} frames, {} boxes in truth, {} detections ({:.2f} a frame)\n"
      "  {:<14}{:>10}{:>10}{:>10}{:>9}\n",
      report.frames, report.score().truth, report.score().detections, report.detections_a_frame(),
      "hit by", "precision", "recall", "F1", "hits");
  for (const MotionReport::AtOverlap& one : report.at_overlap) {
    text += ScoreLine(OverlapName(one.least_overlap), report, one.score);
  }
  text += ScoreLine("centre", report, report.centre);
  text += "  at " + OverlapName(report.at_overlap.front().least_overlap) + ":\n";
  text += "  false alarms a minute: " + Number(report.false_alarms_a_minute(), 1) + "\n";
  if (report.tracks) {
    text += fmt::format("  tracks: {} objects, {} id switches, {} fragmentations\n",
                        report.tracks->objects, report.tracks->id_switches,
                        report.tracks->fragmentations);
  }
  text += ClassLine("recall by size in px:", report.by_size);
  if (!report.by_speed.empty()) {
    text += ClassLine("recall by speed in px a frame:", report.by_speed);
  }
  return text;
}

std::string MotionTable(std::span<const MotionReport> reports, const MotionReport& pooled) {
  const std::size_t width = NameWidth(reports);
  std::vector<std::string> titles = {"sequence",   "frames",    "truth",
                                     "detections", "precision", "recall"};
  for (const MotionReport::AtOverlap& one : pooled.at_overlap) {
    titles.push_back(fmt::format("F1 {}", one.least_overlap));
  }
  titles.insert(titles.end(), {"F1 centre", "false/min", "switches", "fragments"});
  std::string text = Row(titles, width);
  for (const MotionReport& report : reports) text += Row(MotionCells(report), width);
  text += Row(MeanCells(MeanOf(reports)), width);
  text += Row(MotionCells(pooled), width);
  return text;
}

std::string Describe(const RegistrationScore& score) {
  std::string text = fmt::format(
      "registration over {} pairs{}: RMS mean {}, median {}, max {}, {} over {} px", score.pairs,
      score.gap == 1 ? "" : fmt::format(" {} frames apart", score.gap), Pixels(score.mean_px),
      Pixels(score.median_px), Pixels(score.max_px), score.failures, kFailurePx);
  if (score.gap == 1) text += fmt::format(", drift {:.3f} px at the last frame", score.drift_px);
  if (score.without_ground > 0) {
    text += fmt::format("; {} pairs show no common ground", score.without_ground);
  }
  return text + "\n";
}

std::string RegistrationTable(std::span<const NamedRegistrationScore> scores) {
  const std::size_t width = NameWidth(scores);
  std::string text = Row({"sequence", "pairs", "mean px", "median px", "max px",
                          fmt::format("> {} px", kFailurePx), "drift px"},
                         width);
  std::vector<std::optional<double>> means;
  int pairs = 0;
  int failures = 0;
  for (const auto& [name, score] : scores) {
    text += Row(
        {name, std::to_string(score.pairs), Number(score.mean_px, 4), Number(score.median_px, 4),
         Number(score.max_px, 4), std::to_string(score.failures), Number(score.drift_px, 3)},
        width);
    means.push_back(score.mean_px);
    pairs += score.pairs;
    failures += score.failures;
  }
  return text + Row({"mean", std::to_string(pairs), Number(SummaryOf(means).mean, 4), "", "",
                     std::to_string(failures), ""},
                    width);
}

std::string Describe(const VideoScore& score) {
  const Summary cycles = SummaryOf(std::span(score.cycles_px));
  std::string text = "registration without truth:\n";
  text += ResidualText("frame to frame", SummaryOf(score.consecutive));
  text += ResidualText(fmt::format("{} frames apart", score.gap), SummaryOf(score.across_gap));
  text +=
      fmt::format("  {} cycles of {} frames: RMS mean {}, median {}, max {}", cycles.count,
                  score.gap, Pixels(cycles.mean), Pixels(cycles.median), Pixels(cycles.largest));
  if (score.unregistered > 0) {
    text += fmt::format("; {} could not be registered at once", score.unregistered);
  }
  return text + "\n";
}

}  // namespace windhover::replay
