// SPDX-License-Identifier: Apache-2.0
#include "replay/report/measured_document.h"

#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

// Errors say where in the document they are.
#define JSON_DIAGNOSTICS 1
#include <nlohmann/json.hpp>

#include "replay/format/format_error.h"

namespace windhover::replay {
namespace {

using Json = nlohmann::ordered_json;

// The value of a key that need not be there.
template <typename T>
T ValueOr(const Json& json, const char* key, T otherwise) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? otherwise : found->get<T>();
}

// The elements of an array that need not be there, each by `read`.
template <typename T>
std::vector<T> ReadAll(const Json& json, const char* key, T (*read)(const Json&)) {
  std::vector<T> all;
  const auto found = json.find(key);
  if (found == json.end()) return all;
  if (!found->is_array()) throw std::runtime_error(std::string(key) + " is no list");
  for (const Json& element : *found) all.push_back(read(element));
  return all;
}

Figure ReadFigure(const Json& json) { return {json.at("name"), json.at("value"), json.at("unit")}; }

TableCell ReadCell(const Json& json) {
  if (json.is_null()) return {};
  if (json.is_number_integer()) return json.get<int>();
  if (json.is_number()) return json.get<double>();
  return json.get<std::string>();
}

FigureTable ReadTable(const Json& json) {
  FigureTable table = {json.at("name"),
                       json.at("title"),
                       json.at("columns"),
                       {},
                       ValueOr(json, "digits", 2),
                       ValueOr(json, "least_is_best", false)};
  for (const Json& row : json.at("rows")) {
    if (row.size() != table.columns.size()) {
      throw std::runtime_error("table " + table.name + " has a row of " +
                               std::to_string(row.size()) + " cells under " +
                               std::to_string(table.columns.size()) + " columns");
    }
    std::vector<TableCell>& cells = table.rows.emplace_back();
    for (const Json& cell : row) cells.push_back(ReadCell(cell));
  }
  return table;
}

PlotAxis ReadAxis(const Json& json) {
  PlotAxis axis = {json.at("label"), json.at("log"), json.at("categories"), {}};
  if (json.contains("range")) axis.range = json.at("range").get<std::array<double, 2>>();
  return axis;
}

PlotPoint ReadPoint(const Json& json) {
  PlotPoint point = {json.at(0), json.at(1), {}};
  if (json.size() > 2) point.y_high = json.at(2).get<double>();
  return point;
}

PlotSeries ReadSeries(const Json& json) {
  return {json.at("name"), json.at("line"), ReadAll(json, "points", ReadPoint)};
}

FigurePlot::Panel ReadPanel(const Json& json) {
  return {json.at("title"), ReadAll(json, "series", ReadSeries)};
}

FigurePlot ReadPlot(const Json& json) {
  return {json.at("name"), json.at("title"), ReadAxis(json.at("x")), ReadAxis(json.at("y")),
          ReadAll(json, "panels", ReadPanel)};
}

SampleFrame::Mark ReadMark(const Json& json) {
  const std::string kind = json.at("kind");
  const Json& box = json.at("box");
  for (const auto known :
       {SampleFrame::Kind::kHit, SampleFrame::Kind::kFalseAlarm, SampleFrame::Kind::kMiss}) {
    if (kind == NameOf(known)) return {known, {box.at(0), box.at(1), box.at(2), box.at(3)}};
  }
  throw std::runtime_error("no kind of mark is called '" + kind + "'");
}

SampleFrame::View ReadView(const Json& json) {
  return {json.at("title"), ReadAll(json, "marks", ReadMark)};
}

SampleFrame ReadSample(const Json& json) {
  return {json.at("sequence"), json.at("frame"),       json.at("width"),
          json.at("height"),   json.at("jpeg_base64"), ReadAll(json, "views", ReadView)};
}

MeasuredDocument Read(const std::filesystem::path& file, const Json& json) {
  if (!json.is_object()) {
    throw std::runtime_error(std::string("is no object as 'bench --json' writes it, but of type ") +
                             json.type_name());
  }
  MeasuredDocument document = {file, {}, {}};
  const Json& machine = json.at("machine");
  document.machine = {machine.at("processor"), machine.at("cores"), machine.at("memory_gib")};
  BenchmarkDocument& content = document.content;
  content.device = json.at("device");
  content.dataset_sha256 = ValueOr(json, "dataset_sha256", std::string());
  for (const auto& [name, value] : json.at("options").items()) {
    content.options.emplace_back(name, value.get<std::string>());
  }
  json.at("figures");  // must be there
  content.figures = ReadAll(json, "figures", ReadFigure);
  content.tables = ReadAll(json, "tables", ReadTable);
  content.plots = ReadAll(json, "plots", ReadPlot);
  content.samples = ReadAll(json, "samples", ReadSample);
  content.left_out = ValueOr(json, "left_out", std::vector<std::string>());
  return document;
}

std::string Difference(const MeasuredDocument& a, const MeasuredDocument& b) {
  if (a.machine.processor != b.machine.processor || a.machine.cores != b.machine.cores ||
      a.machine.memory_gib != b.machine.memory_gib) {
    return "from different machines";
  }
  if (a.content.device != b.content.device) return "from different devices";
  if (a.content.dataset_sha256 != b.content.dataset_sha256) return "of different datasets";
  if (a.content.options != b.content.options) return "with different options";
  return "measured twice";
}

}  // namespace

MeasuredDocument ReadMeasured(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) throw FormatError(file, "cannot be read");
  try {
    return Read(file, Json::parse(in));
  } catch (const Json::exception& error) {
    // Without the library's "[json.exception.name.number] ".
    const std::string text = error.what();
    throw FormatError(file, text.substr(text.find("] ") + 2));
  } catch (const FormatError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw FormatError(file, error.what());
  }
}

void CheckNoFigureTwice(const std::vector<MeasuredDocument>& documents) {
  std::map<std::string, const MeasuredDocument*> of;
  for (const MeasuredDocument& document : documents) {
    for (const Figure& figure : document.content.figures) {
      const auto [first, is_new] = of.emplace(figure.name, &document);
      if (is_new) continue;
      throw FormatError(document.file, "has " + figure.name + " as " +
                                           first->second->file.string() + " has, " +
                                           Difference(*first->second, document));
    }
  }
}

}  // namespace windhover::replay
