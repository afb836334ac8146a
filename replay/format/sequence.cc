// SPDX-License-Identifier: Apache-2.0
#include "replay/format/sequence.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "replay/format/format_error.h"
#include "replay/format/media_files.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

int WholeNumber(const std::filesystem::path& file, std::size_t line, std::string_view text) {
  const std::optional<double> value = ParseNumber(text);
  if (!value || *value != std::floor(*value) || *value < 1 || *value > 1e8) {
    throw FormatError(file, line,
                      "expected a whole number from 1, got '" + std::string(text) + "'");
  }
  return static_cast<int>(*value);
}

}  // namespace

SequenceInfo ReadSequenceInfo(const std::filesystem::path& sequence) {
  const std::filesystem::path file = sequence / "seqinfo.ini";
  SequenceInfo info;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    if (text.front() == '[' || text.front() == ';' || text.front() == '#') return;
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) {
      throw FormatError(file, line, "expected key=value, got '" + std::string(text) + "'");
    }
    const std::string_view key = Trimmed(text.substr(0, equals));
    const std::string_view value = Trimmed(text.substr(equals + 1));
    if (key == "name") info.name = value;
    if (key == "renderedBy") info.rendered_by = value;
    if (key == "imDir") info.image_folder = value;
    if (key == "imExt") info.image_extension = value;
    if (key == "seqLength") info.frames = WholeNumber(file, line, value);
    if (key == "imWidth") info.width = WholeNumber(file, line, value);
    if (key == "imHeight") info.height = WholeNumber(file, line, value);
    if (key == "frameRate") {
      const std::optional<double> rate = ParseNumber(value);
      if (!rate || *rate <= 0) {
        throw FormatError(file, line, "expected a rate above 0, got '" + std::string(value) + "'");
      }
      info.frame_rate_hz = *rate;
    }
  });
  if (info.frames == 0) throw FormatError(file, "seqLength is missing");
  if (info.width == 0) throw FormatError(file, "imWidth is missing");
  if (info.height == 0) throw FormatError(file, "imHeight is missing");
  if (info.name.empty()) info.name = std::filesystem::absolute(sequence).filename().string();
  return info;
}

void WriteSequenceInfo(const std::filesystem::path& sequence, const SequenceInfo& info) {
  WriteText(sequence / "seqinfo.ini",
            "[Sequence]\nname=" + info.name + "\nimDir=" + info.image_folder + "\nframeRate=" +
                NumberText(info.frame_rate_hz, 17) + "\nseqLength=" + std::to_string(info.frames) +
                "\nimWidth=" + std::to_string(info.width) +
                "\nimHeight=" + std::to_string(info.height) + "\nimExt=" + info.image_extension +
                (info.rendered_by.empty() ? "" : "\nrenderedBy=" + info.rendered_by) + "\n");
}

std::filesystem::path FramePath(const std::filesystem::path& sequence, const SequenceInfo& info,
                                int frame) {
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "%06d", frame);
  return sequence / info.image_folder / (number.data() + info.image_extension);
}

std::optional<std::filesystem::path> SequenceVideo(const std::filesystem::path& sequence,
                                                   const SequenceInfo& info) {
  if (std::filesystem::is_directory(sequence / info.image_folder)) return std::nullopt;
  const std::vector<std::filesystem::path> videos = ListVideos(sequence);
  if (videos.empty())
    throw FormatError(sequence / info.image_folder, "is missing, and so is a video");
  if (videos.size() > 1) throw FormatError(sequence, "holds several videos: which one is meant?");
  return videos.front();
}

}  // namespace windhover::replay
