// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "replay/benchmarks/machine.h"

namespace windhover::replay {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const TableCell& cell) {
  if (const double* number = std::get_if<double>(&cell)) {
    return std::isfinite(*number) ? Json(*number) : Json(nullptr);
  }
  if (const int* count = std::get_if<int>(&cell)) return *count;
  if (const std::string* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

Json ToJson(const FigureTable& table) {
  Json rows = Json::array();
  for (const std::vector<TableCell>& row : table.rows) {
    if (row.size() != table.columns.size()) {
      throw std::invalid_argument("table " + table.name + " has a row of " +
                                  std::to_string(row.size()) + " cells under " +
                                  std::to_string(table.columns.size()) + " columns");
    }
    Json cells = Json::array();
    for (const TableCell& cell : row) cells.push_back(ToJson(cell));
    rows.push_back(std::move(cells));
  }
  return {{"name", table.name}, {"title", table.title},   {"columns", table.columns},
          {"rows", rows},       {"digits", table.digits}, {"least_is_best", table.least_is_best}};
}

Json ToJson(const PlotAxis& axis) {
  Json json = {{"label", axis.label}, {"log", axis.log}, {"categories", axis.categories}};
  if (axis.range) json["range"] = *axis.range;
  return json;
}

Json ToJson(const PlotSeries& series) {
  Json points = Json::array();
  for (const PlotPoint& point : series.points) {
    Json numbers = {point.x, point.y};
    if (point.y_high) numbers.push_back(*point.y_high);
    points.push_back(std::move(numbers));
  }
  return {{"name", series.name}, {"line", series.line}, {"points", points}};
}

Json ToJson(const FigurePlot& plot) {
  Json panels = Json::array();
  for (const FigurePlot::Panel& panel : plot.panels) {
    Json series = Json::array();
    for (const PlotSeries& one : panel.series) series.push_back(ToJson(one));
    panels.push_back({{"title", panel.title}, {"series", series}});
  }
  return {{"name", plot.name},
          {"title", plot.title},
          {"x", ToJson(plot.x)},
          {"y", ToJson(plot.y)},
          {"panels", panels}};
}

Json ToJson(const SampleFrame& sample) {
  Json views = Json::array();
  for (const SampleFrame::View& view : sample.views) {
    Json marks = Json::array();
    for (const SampleFrame::Mark& mark : view.marks) {
      const Box& box = mark.box;
      marks.push_back(
          {{"kind", NameOf(mark.kind)}, {"box", {box.x, box.y, box.width, box.height}}});
    }
    views.push_back({{"title", view.title}, {"marks", marks}});
  }
  return {
      {"sequence", sample.sequence}, {"frame", sample.frame}, {"width", sample.width},
      {"height", sample.height},     {"views", views},        {"jpeg_base64", sample.jpeg_base64}};
}

}  // namespace

std::string CellText(const TableCell& cell, int digits) {
  if (const std::string* text = std::get_if<std::string>(&cell)) return *text;
  if (const int* count = std::get_if<int>(&cell)) return std::to_string(*count);
  const double* number = std::get_if<double>(&cell);
  if (number == nullptr) return "-";
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, *number);
  return text;
}

const char* NameOf(SampleFrame::Kind kind) {
  switch (kind) {
    case SampleFrame::Kind::kHit:
      return "hit";
    case SampleFrame::Kind::kFalseAlarm:
      return "false alarm";
    case SampleFrame::Kind::kMiss:
      return "miss";
  }
  return "";
}

void AddFigure(std::vector<Figure>& figures, std::string name, std::optional<double> value,
               std::string unit) {
  if (value) figures.push_back({std::move(name), *value, std::move(unit)});
}

TableCell CellOf(std::optional<double> value) {
  if (value) return *value;
  return std::monostate();
}

std::string JsonText(const BenchmarkDocument& document) {
  const MachineInfo machine = ThisMachine();
  Json json;
  json["machine"] = {{"processor", machine.processor},
                     {"cores", machine.cores},
                     {"memory_gib", machine.memory_gib}};
  json["device"] = document.device;
  json["dataset_sha256"] =
      document.dataset_sha256.empty() ? Json(nullptr) : Json(document.dataset_sha256);
  json["options"] = Json::object();
  for (const auto& [name, value] : document.options) json["options"][name] = value;
  json["figures"] = Json::array();
  for (const Figure& figure : document.figures) {
    if (!std::isfinite(figure.value)) {
      throw std::invalid_argument("figure " + figure.name + " is not finite");
    }
    json["figures"].push_back(
        {{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
  }
  json["tables"] = Json::array();
  for (const FigureTable& table : document.tables) json["tables"].push_back(ToJson(table));
  json["plots"] = Json::array();
  for (const FigurePlot& plot : document.plots) json["plots"].push_back(ToJson(plot));
  json["samples"] = Json::array();
  for (const SampleFrame& sample : document.samples) json["samples"].push_back(ToJson(sample));
  json["left_out"] = document.left_out;
  return json.dump(2) + "\n";
}

std::string TableText(const FigureTable& table) {
  std::vector<std::vector<std::string>> lines = {table.columns};
  for (const std::vector<TableCell>& row : table.rows) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const TableCell& cell : row) line.push_back(CellText(cell, table.digits));
  }
  std::vector<std::size_t> widths(table.columns.size(), 0);
  for (const std::vector<std::string>& line : lines) {
    for (std::size_t i = 0; i < line.size() && i < widths.size(); ++i) {
      widths[i] = std::max(widths[i], line[i].size());
    }
  }
  std::string text = table.title + "\n";
  for (const std::vector<std::string>& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size() && i < widths.size(); ++i) {
      const std::string gap(widths[i] - line[i].size(), ' ');
      row += i == 0 ? line[i] + gap : "  " + gap + line[i];
    }
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + "\n";
  }
  return text;
}

}  // namespace windhover::replay
