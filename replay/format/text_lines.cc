// SPDX-License-Identifier: Apache-2.0
#include "replay/format/text_lines.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>

#include "replay/format/format_error.h"
#include "replay/format/pending_file.h"

namespace windhover::replay {
namespace {

constexpr std::string_view kBlanks = " \t\r";

}  // namespace

void ForEachLine(const std::filesystem::path& file,
                 const std::function<void(std::size_t, std::string_view)>& visit) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) throw FormatError(file, "cannot be read");
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!Trimmed(line).empty()) visit(number, Trimmed(line));
  }
  if (in.bad()) throw FormatError(file, "reading failed");
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  const bool blanks = separator == ' ';
  while (true) {
    const std::size_t end = blanks ? text.find_first_of(kBlanks) : text.find(separator);
    const std::string_view part = Trimmed(text.substr(0, end));
    if (!blanks || !part.empty()) parts.push_back(part);
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> ParseNumber(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::vector<double> ParseColumns(const std::filesystem::path& file, std::size_t line,
                                 std::string_view text, std::size_t least, std::size_t most) {
  std::vector<std::string_view> parts =
      Split(text, text.find(',') == std::string_view::npos ? ' ' : ',');
  if (parts.size() > 1 && parts.back().empty()) parts.pop_back();
  if (parts.size() < least || parts.size() > most) {
    const std::string expected = least == most
                                     ? std::to_string(least)
                                     : std::to_string(least) + " to " + std::to_string(most);
    throw FormatError(file, line,
                      "expected " + expected + " columns, got " + std::to_string(parts.size()));
  }
  std::vector<double> columns;
  for (const std::string_view part : parts) {
    const std::optional<double> value = ParseNumber(part);
    if (!value) {
      throw FormatError(file, line,
                        "column " + std::to_string(columns.size() + 1) + " is no number: '" +
                            std::string(part) + "'");
    }
    columns.push_back(*value);
  }
  return columns;
}

void WriteText(const std::filesystem::path& file, const std::string& text) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  PendingFile pending(file);
  std::ofstream out(pending.temporary(), std::ios::binary);
  out << text;
  out.close();
  if (!out) throw FormatError(file, "cannot be written");
  pending.Complete();
}

std::string NumberText(double value, int digits) {
  std::array<char, 64> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value,
                                          std::chars_format::general, digits);
  return {text.data(), error == std::errc() ? end : text.data()};
}

}  // namespace windhover::replay
