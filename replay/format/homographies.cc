// SPDX-License-Identifier: Apache-2.0
#include "replay/format/homographies.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

constexpr int kDigits = 17;

Eigen::Matrix3d ParseHomography(const std::filesystem::path& file, std::size_t line,
                                std::string_view text, std::size_t expected_frame) {
  const std::vector<std::string_view> parts = Split(text, ' ');
  if (parts.size() != 10) {
    throw FormatError(file, line,
                      "expected a frame number and 9 numbers, got " + std::to_string(parts.size()));
  }
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 10; ++i) {
    const std::optional<double> value = ParseNumber(parts[i]);
    if (!value) {
      throw FormatError(
          file, line,
          "column " + std::to_string(i + 1) + " is no number: '" + std::string(parts[i]) + "'");
    }
    if (i == 0 && *value != static_cast<double>(expected_frame)) {
      throw FormatError(file, line, "expected frame " + std::to_string(expected_frame));
    }
    if (i > 0) matrix((i - 1) / 3, (i - 1) % 3) = *value;
  }
  const double determinant = matrix.determinant();
  if (!std::isfinite(determinant) || std::abs(determinant) < 1e-12) {
    throw FormatError(file, line, "the matrix has no inverse");
  }
  return matrix;
}

}  // namespace

std::vector<Eigen::Matrix3d> ReadHomographies(const std::filesystem::path& file) {
  std::vector<Eigen::Matrix3d> matrices;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    matrices.push_back(ParseHomography(file, line, text, matrices.size() + 1));
  });
  return matrices;
}

void WriteHomographies(const std::filesystem::path& file,
                       const std::vector<Eigen::Matrix3d>& first_from_frame) {
  std::string text;
  for (std::size_t i = 0; i < first_from_frame.size(); ++i) {
    text += std::to_string(i + 1);
    for (int j = 0; j < 9; ++j) {
      text += " " + NumberText(first_from_frame[i](j / 3, j % 3), kDigits);
    }
    text += "\n";
  }
  WriteText(file, text);
}

}  // namespace windhover::replay
