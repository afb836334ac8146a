// SPDX-License-Identifier: Apache-2.0
#include "replay/readers/target_boxes.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "replay/readers/layout_reader.h"

namespace windhover::replay {
namespace {

bool IsNan(std::string_view text) {
  constexpr std::string_view kNan = "nan";
  return std::equal(text.begin(), text.end(), kNan.begin(), kNan.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

bool IsAbsent(std::string_view text) {
  const std::vector<std::string_view> parts =
      Split(text, text.find(',') == std::string_view::npos ? ' ' : ',');
  return parts.size() == 4 && std::all_of(parts.begin(), parts.end(), IsNan);
}

}  // namespace

std::vector<std::optional<Box>> ReadTargetBoxes(const std::filesystem::path& file) {
  std::vector<std::optional<Box>> boxes;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    if (line != boxes.size() + 1) throw FormatError(file, boxes.size() + 1, "is blank");
    if (IsAbsent(text)) {
      boxes.emplace_back();
      return;
    }
    const std::vector<double> columns = ParseColumns(file, line, text, 4, 4);
    const Box box = {columns[0], columns[1], columns[2], columns[3]};
    boxes.push_back(HasArea(file, line, box) ? std::optional<Box>(box) : std::nullopt);
  });
  return boxes;
}

void UseTargetBoxes(Recording& recording, const std::filesystem::path& file,
                    const std::vector<std::optional<Box>>& boxes) {
  if (recording.knows_frames && static_cast<int>(boxes.size()) != recording.frames) {
    throw FormatError(file, "has " + std::to_string(boxes.size()) +
                                " lines, but the recording has " +
                                std::to_string(recording.frames) + " frames");
  }
  recording.labelling = Labelling::kOneTarget;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i]) continue;
    Label label;
    label.box.frame = static_cast<int>(i) + 1;
    label.box.id = 1;
    label.box.box = *boxes[i];
    recording.labels.push_back(label);
  }
}

}  // namespace windhover::replay
