// SPDX-License-Identifier: Apache-2.0
#include "replay/format/labels.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

// Digits of box coordinates: a hundredth of a pixel at 10000 px.
constexpr int kBoxDigits = 8;
constexpr std::size_t kLeastColumns = 7;
constexpr std::size_t kClassColumn = 7;
constexpr std::size_t kVisibleColumn = 8;

LabelledBox ParseBox(const std::filesystem::path& file, std::size_t line, std::string_view text) {
  const std::vector<std::string_view> parts = Split(text, ',');
  if (parts.size() < kLeastColumns) {
    throw FormatError(file, line,
                      "expected at least " + std::to_string(kLeastColumns) +
                          " comma-separated columns, got " + std::to_string(parts.size()));
  }
  std::array<double, kVisibleColumn + 1> values{};
  values[kClassColumn] = 1.0;
  values[kVisibleColumn] = 1.0;
  for (std::size_t i = 0; i < parts.size() && i < values.size(); ++i) {
    const std::optional<double> value = ParseNumber(parts[i]);
    if (!value) {
      throw FormatError(
          file, line,
          "column " + std::to_string(i + 1) + " is no number: '" + std::string(parts[i]) + "'");
    }
    values[i] = *value;
  }
  const auto [frame, id, left, top, width, height, score, kind, visible] = values;
  if (frame != std::floor(frame) || frame < 1 || frame > 1e8) {
    throw FormatError(file, line, "the frame number must be whole and from 1");
  }
  if (id != std::floor(id) || std::abs(id) > 1e15) {
    throw FormatError(file, line, "the id must be whole");
  }
  if (kind != std::floor(kind) || std::abs(kind) > 1e6) {
    throw FormatError(file, line, "the class must be whole");
  }
  if (width <= 0 || height <= 0) {
    throw FormatError(file, line, "width and height must be above 0");
  }
  return {static_cast<int>(frame),
          static_cast<std::int64_t>(id),
          {left - 1, top - 1, width, height},
          score,
          visible,
          static_cast<int>(kind)};
}

std::string BoxText(const LabelledBox& box) {
  std::string text = std::to_string(box.frame) + "," + std::to_string(box.id);
  for (const double value : {box.box.x + 1, box.box.y + 1, box.box.width, box.box.height}) {
    text += "," + NumberText(value, kBoxDigits);
  }
  return text;
}

std::vector<LabelledBox> ReadJsonLines(const std::filesystem::path& file) {
  std::vector<LabelledBox> boxes;
  std::string stream;
  bool first = true;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    try {
      const nlohmann::json sample = nlohmann::json::parse(text);
      if (sample.at("type") != "detections") return;
      if (first) stream = sample.at("stream");
      if (stream != sample.at("stream")) throw FormatError(file, line, "a second stream");
      first = false;
      const int frame = sample.at("frame").get<int>() + 1;
      for (const nlohmann::json& one : sample.at("detections")) {
        boxes.push_back({frame,
                         one.at("track").get<std::int64_t>(),
                         {one.at("x"), one.at("y"), one.at("width"), one.at("height")},
                         one.at("score")});
      }
    } catch (const nlohmann::json::exception& error) {
      throw FormatError(file, line, error.what());
    }
  });
  return boxes;
}

}  // namespace

std::vector<LabelledBox> ReadBoxes(const std::filesystem::path& file) {
  std::vector<LabelledBox> boxes;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    boxes.push_back(ParseBox(file, line, text));
  });
  return boxes;
}

void WriteTruthBoxes(const std::filesystem::path& file, const std::vector<LabelledBox>& boxes) {
  std::string text;
  for (const LabelledBox& box : boxes) {
    text += BoxText(box) + "," + NumberText(box.score, 3) + "," + std::to_string(box.object_class) +
            "," + NumberText(box.visible, 3) + "\n";
  }
  WriteText(file, text);
}

void WriteDetections(const std::filesystem::path& file, const std::vector<LabelledBox>& boxes) {
  std::string text;
  for (const LabelledBox& box : boxes) {
    text += BoxText(box) + "," + NumberText(box.score, 4) + ",-1,-1,-1\n";
  }
  WriteText(file, text);
}

std::vector<LabelledBox> ReadDetections(const std::filesystem::path& file) {
  return file.extension() == ".jsonl" ? ReadJsonLines(file) : ReadBoxes(file);
}

}  // namespace windhover::replay
