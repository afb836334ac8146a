// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace windhover::replay {

// Calls visit(line number from 1, text without line end) for every line that is not blank. Throws
// FormatError where the file cannot be read.
void ForEachLine(const std::filesystem::path& file,
                 const std::function<void(std::size_t, std::string_view)>& visit);

std::string_view Trimmed(std::string_view text);

// The parts between separators, trimmed. A separator of ' ' stands for any run of blanks.
std::vector<std::string_view> Split(std::string_view text, char separator);

// A finite number that is the whole of `text`, in the C locale; nothing otherwise.
std::optional<double> ParseNumber(std::string_view text);

// The numbers of a line, `least` to `most` of them: separated by commas, or by blanks where it has
// no comma. One comma at the end is passed over. Throws FormatError with file and line where there
// are fewer or more, or something else than a number.
std::vector<double> ParseColumns(const std::filesystem::path& file, std::size_t line,
                                 std::string_view text, std::size_t least, std::size_t most);

// Writes `text` to `file` in one step (a reader sees the old content or the new), making its folder
// where it is missing. Throws FormatError.
void WriteText(const std::filesystem::path& file, const std::string& text);

// The shortest text with at most `digits` significant digits, in the C locale.
std::string NumberText(double value, int digits);

}  // namespace windhover::replay
