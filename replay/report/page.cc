// SPDX-License-Identifier: Apache-2.0
#include "replay/report/page.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>

#include "replay/format/text_lines.h"
#include "replay/report/markup.h"
#include "replay/report/page_style.h"
#include "replay/report/plot_svg.h"
#include "replay/report/sample_html.h"

namespace windhover::replay {
namespace {

constexpr int kAllDigits = 17;
constexpr std::size_t kWideColumns = 11;

std::string Text(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + Escaped(text) + "</" + tag.substr(0, tag.find(' ')) + ">";
}

// What a document is about: the first part of its names.
std::string SubjectOf(const BenchmarkDocument& document) {
  std::string subject = !document.tables.empty()    ? document.tables.front().name
                        : !document.figures.empty() ? document.figures.front().name
                                                    : "benchmark";
  subject.resize(std::min(subject.size(), subject.find('.')));
  if (!subject.empty()) subject[0] = static_cast<char>(std::toupper(subject[0]));
  return subject;
}

// "-" where it is absent.
std::string OptionOf(const BenchmarkDocument& document, const std::string& name) {
  for (const auto& [option, value] : document.options) {
    if (option == name) return value;
  }
  return "-";
}

std::string RunsHtml(const std::vector<MeasuredDocument>& documents) {
  std::string html =
      "<div class='table'><table id='runs'><caption>Runs</caption><thead><tr>"
      "<th class='text'>benchmark</th><th class='text'>machine</th><th>cores</th>"
      "<th>memory GiB</th><th class='text'>device</th><th class='text'>dataset SHA-256</th>"
      "<th>frames</th><th class='text'>file</th></tr></thead><tbody>\n";
  for (const MeasuredDocument& one : documents) {
    const std::string& sum = one.content.dataset_sha256;
    html += "<tr>" + Text("td class='text'", SubjectOf(one.content)) +
            Text("td class='text'", one.machine.processor) +
            Text("td", std::to_string(one.machine.cores)) +
            Text("td", CellText(one.machine.memory_gib, 1)) +
            Text("td class='text'", one.content.device) + "<td class='text'><code title='" +
            Escaped(sum) + "'>" + (sum.empty() ? "-" : Escaped(sum.substr(0, 12)) + "…") +
            "</code></td>" + Text("td", OptionOf(one.content, "frames")) +
            Text("td class='text'", one.file.filename().string()) + "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

bool IsText(const TableCell& cell) { return std::holds_alternative<std::string>(cell); }

// Texts stand to the left where a column has nothing else.
std::vector<bool> TextColumns(const FigureTable& table) {
  std::vector<bool> texts(table.columns.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    texts[i] = std::all_of(table.rows.begin(), table.rows.end(),
                           [i](const std::vector<TableCell>& row) { return IsText(row[i]); });
  }
  return texts;
}

std::optional<double> NumberOf(const TableCell& cell) {
  if (const double* number = std::get_if<double>(&cell)) return *number;
  if (const int* count = std::get_if<int>(&cell)) return *count;
  return std::nullopt;
}

// `best` is nothing where no number stands out.
std::string CellHtml(const TableCell& cell, int digits, bool text_column,
                     std::optional<double> best) {
  if (std::holds_alternative<std::monostate>(cell)) return "<td class='none'>–</td>";
  const std::string text = Escaped(CellText(cell, digits));
  const std::optional<double> value = NumberOf(cell);
  if (!value) return (text_column ? "<td class='text'>" : "<td>") + text + "</td>";
  return std::string(value == best ? "<td class='best'>" : "<td>") + "<data value='" +
         NumberText(*value, kAllDigits) + "'>" + text + "</data></td>";
}

// Nothing where the row has but one number.
std::optional<double> LeastOf(const std::vector<TableCell>& row) {
  std::vector<double> numbers;
  for (const TableCell& cell : row) {
    if (const std::optional<double> number = NumberOf(cell)) numbers.push_back(*number);
  }
  if (numbers.size() < 2) return std::nullopt;
  return *std::min_element(numbers.begin(), numbers.end());
}

std::string TableHtml(const FigureTable& table) {
  const std::vector<bool> texts = TextColumns(table);
  std::string html =
      table.columns.size() >= kWideColumns ? "<div class='table wide'>" : "<div class='table'>";
  html += "<table id='" + Escaped(table.name) + "'>" + Text("caption", table.title) + "<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    html += Text(texts[i] ? "th class='text'" : "th", table.columns[i]);
  }
  html += "</tr></thead><tbody>\n";
  for (const std::vector<TableCell>& row : table.rows) {
    const bool thesis = std::find(row.begin(), row.end(), TableCell("thesis")) != row.end();
    html += thesis ? "<tr class='thesis'>" : "<tr>";
    const std::optional<double> best = table.least_is_best ? LeastOf(row) : std::nullopt;
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += CellHtml(row[i], table.digits, texts[i], best);
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string PairsHtml(const std::string& title,
                      const std::vector<std::pair<std::string, std::string>>& pairs) {
  if (pairs.empty()) return "";
  std::string html = Text("h3", title) + "\n<div class='columns'>";
  for (const auto& [name, value] : pairs) {
    html += "<div>" + Text("span", name) + Text("span", value) + "</div>\n";
  }
  return html + "</div>\n";
}

std::string FiguresHtml(const std::vector<Figure>& figures) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const Figure& figure : figures) {
    const std::string unit = figure.unit.empty() ? "" : " " + figure.unit;
    pairs.emplace_back(figure.name, NumberText(figure.value, 5) + unit);
  }
  return PairsHtml("All figures", pairs);
}

std::string LeftOutHtml(const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string html = "<h3>Left out</h3>\n<ul class='soft'>";
  for (const std::string& line : lines) html += Text("li", line) + "\n";
  return html + "</ul>\n";
}

// A plot stands before the table of its name, or before all tables.
std::string DocumentHtml(const MeasuredDocument& document, const std::string& id,
                         SeriesStyles& styles) {
  const BenchmarkDocument& content = document.content;
  std::string html = "<section>" + Text("h2", SubjectOf(content)) + "\n";
  const auto plots_called = [&](const std::string& name) {
    std::string plots;
    for (const FigurePlot& plot : content.plots) {
      if (plot.name == name) plots += PlotHtml(plot, styles);
    }
    return plots;
  };
  std::set<std::string> names;
  for (const FigureTable& table : content.tables) names.insert(table.name);
  for (const FigurePlot& plot : content.plots) {
    if (!names.contains(plot.name)) html += PlotHtml(plot, styles);
  }
  for (const FigureTable& table : content.tables) {
    html += plots_called(table.name) + TableHtml(table);
  }
  html += SamplesHtml(content.samples, id) + FiguresHtml(content.figures) +
          PairsHtml("Options", content.options) + LeftOutHtml(content.left_out);
  return html + "</section>\n";
}

}  // namespace

std::string PageHtml(const std::vector<MeasuredDocument>& documents) {
  std::string html =
      "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'/>"
      "<meta name='viewport' content='width=device-width, initial-scale=1'/>"
      "<title>Windhover benchmarks</title><style>";
  html += kPageStyle;
  html +=
      "</style></head><body>\n<h1>Windhover benchmarks</h1>\n<p>Windhover beside its peers and the "
      "thesis. Windhover and peers were measured on the datasets named below; the thesis' figures "
      "are of its own recordings, which were never published.</p>\n";
  html += RunsHtml(documents);
  SeriesStyles styles;
  for (std::size_t i = 0; i < documents.size(); ++i) {
    html += DocumentHtml(documents[i], "frame-" + std::to_string(i + 1), styles);
  }
  return html + "</body></html>\n";
}

}  // namespace windhover::replay
