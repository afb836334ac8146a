// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "service/vision/types.h"

namespace windhover::replay {

// One measured number. Names are stable, so that scripts can hold figures against goals; README.md
// beside this file lists them. A figure that was not measured does not exist.
struct Figure {
  std::string name;
  double value = 0;  // finite
  std::string unit;  // "" for counts, shares and ratios
};

// Appends the figure where there is a value.
void AddFigure(std::vector<Figure>& figures, std::string name, std::optional<double> value,
               std::string unit = "");

// A number, a count, a text, or nothing: not measured.
using TableCell = std::variant<std::monostate, double, int, std::string>;
TableCell CellOf(std::optional<double> value);
// For people, with so many digits after the point; "-" where there is nothing.
std::string CellText(const TableCell& cell, int digits);

struct FigureTable {
  std::string name;   // stable, as those of figures
  std::string title;  // for people
  std::vector<std::string> columns;
  std::vector<std::vector<TableCell>> rows;  // each of as many cells as there are columns
  int digits = 2;                            // after the point, for people
  bool least_is_best = false;                // the least number of a row stands out
};

struct PlotAxis {
  std::string label;  // with the unit
  bool log = false;
  std::vector<std::string> categories;  // where there are any, a value is an index into them
  // What is shown at least; otherwise what the points need.
  std::optional<std::array<double, 2>> range;
};

struct PlotPoint {
  double x = 0;
  double y = 0;
  std::optional<double> y_high;  // where a whisker ends
};

// Of one contestant, who looks the same in all plots of the same series name.
struct PlotSeries {
  std::string name;
  bool line = false;  // joins the points
  std::vector<PlotPoint> points;
};

// One picture for each panel, all with the same axes.
struct FigurePlot {
  struct Panel {
    std::string title;
    std::vector<PlotSeries> series;
  };
  std::string name;   // stable, as those of figures
  std::string title;  // for people
  PlotAxis x;
  PlotAxis y;
  std::vector<Panel> panels;
};

// A frame with what contestants have detected in it.
struct SampleFrame {
  enum class Kind : std::uint8_t { kHit, kFalseAlarm, kMiss };
  struct Mark {
    Kind kind;
    Box box;  // px
  };
  struct View {
    std::string title;  // the contestant's
    std::vector<Mark> marks;
  };
  std::string sequence;
  int frame = 0;   // from 1
  int width = 0;   // px
  int height = 0;  // px
  std::string jpeg_base64;
  std::vector<View> views;
};
// "hit", "false alarm", "miss".
const char* NameOf(SampleFrame::Kind kind);

// What one run of a benchmark has found.
struct BenchmarkDocument {
  std::string device;
  std::string dataset_sha256;  // DatasetSha256, or empty where no dataset took part
  std::vector<std::pair<std::string, std::string>> options;
  std::vector<Figure> figures;
  std::vector<FigureTable> tables;
  std::vector<FigurePlot> plots;
  std::vector<SampleFrame> samples;
  std::vector<std::string> left_out;  // what is absent and why, a line each
};

// {"machine", "device", "dataset_sha256", "options", "figures", "tables", "plots", "samples",
// "left_out"}; README.md beside this file says more. A cell of a table that holds nothing is null.
// ReadMeasured (report/measured_document.h) is the way back. Throws std::invalid_argument for a
// figure that is not finite and for a row of another length than the columns.
std::string JsonText(const BenchmarkDocument& document);

// Title and aligned columns, numbers to the right; "-" where there is nothing.
std::string TableText(const FigureTable& table);

}  // namespace windhover::replay
