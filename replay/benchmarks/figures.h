// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

struct FigureTable {
  std::string name;   // stable, as those of figures
  std::string title;  // for people
  std::vector<std::string> columns;
  std::vector<std::vector<TableCell>> rows;  // each of as many cells as there are columns
  int digits = 2;                            // after the point, for people
};

// What one run of a benchmark has found.
struct BenchmarkDocument {
  std::string device;
  std::string dataset_sha256;  // DatasetSha256, or empty where no dataset took part
  std::vector<std::pair<std::string, std::string>> options;
  std::vector<Figure> figures;
  std::vector<FigureTable> tables;
  std::vector<std::string> left_out;  // what is absent and why, a line each
};

// {"machine", "device", "dataset_sha256", "options", "figures", "tables", "left_out"}; a cell of a
// table that holds nothing is null. Throws std::invalid_argument for a figure that is not finite
// and for a row of another length than the columns.
std::string JsonText(const BenchmarkDocument& document);

// Title and aligned columns, numbers to the right; "-" where there is nothing.
std::string TableText(const FigureTable& table);

}  // namespace windhover::replay
