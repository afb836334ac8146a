// SPDX-License-Identifier: Apache-2.0
#include "replay/format/horizon.h"

#include <string>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {

std::vector<Eigen::Vector3d> ReadHorizons(const std::filesystem::path& file) {
  std::vector<Eigen::Vector3d> horizons;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    const std::vector<double> columns = ParseColumns(file, line, text, 4, 4);
    if (columns[0] != static_cast<double>(horizons.size() + 1)) {
      throw FormatError(file, line, "expected frame " + std::to_string(horizons.size() + 1));
    }
    const Eigen::Vector3d horizon(columns[1], columns[2], columns[3]);
    const double length = horizon.head<2>().norm();
    if (length < 1e-9) throw FormatError(file, line, "a and b must not both be 0");
    horizons.push_back(horizon / length);
  });
  return horizons;
}

void WriteHorizons(const std::filesystem::path& file,
                   const std::vector<Eigen::Vector3d>& horizons) {
  std::string text;
  for (std::size_t i = 0; i < horizons.size(); ++i) {
    text += std::to_string(i + 1);
    for (const double value : horizons[i]) text += " " + NumberText(value, 17);
    text += "\n";
  }
  WriteText(file, text);
}

}  // namespace windhover::replay
