// SPDX-License-Identifier: Apache-2.0
// VisDrone VID and MOT (github.com/VisDrone, the README files of VisDrone2018-VID-toolkit and
// VisDrone2018-MOT-toolkit): sequences/NAME/0000001.jpg and annotations/NAME.txt with ten columns:
// frame from 1, id, left, top, width, height, a flag that is 0 for what does not count, category,
// truncation (0 none, 1 up to half) and occlusion (0 none, 1 up to half, 2 more). Category 0 marks
// regions that were not labelled. Pixels are taken to count from 0: boxes at 0 occur.
#include <array>
#include <cmath>
#include <string_view>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "replay/readers/layout_reader.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 12> kCategories = {
    "ignored region", "pedestrian", "people",          "bicycle", "car",   "van",
    "truck",          "tricycle",   "awning-tricycle", "bus",     "motor", "others"};

fs::path AnnotationFile(const fs::path& path) {
  return path.parent_path().parent_path() / "annotations" / (path.filename().string() + ".txt");
}

bool Recognises(const fs::path& path) {
  return fs::is_directory(path) && path.parent_path().filename() == "sequences" &&
         fs::is_directory(AnnotationFile(path).parent_path());
}

Recording Locate(const fs::path& path) {
  return LocatePictures(path, "VisDrone", ListNumberedPictures(path));
}

Label ParseLabel(const fs::path& file, std::size_t line, const std::vector<double>& columns) {
  if (columns[1] != std::floor(columns[1])) throw FormatError(file, line, "the id must be whole");
  if (columns[6] != 0 && columns[6] != 1) throw FormatError(file, line, "the flag must be 0 or 1");
  const double category = columns[7];
  if (category != std::floor(category) || category < 0 ||
      category >= static_cast<double>(kCategories.size())) {
    throw FormatError(file, line, "there is no category " + NumberText(category, 6));
  }
  Label label;
  label.box.frame = static_cast<int>(columns[0]);
  label.box.id = category == 0 ? -1 : static_cast<std::int64_t>(columns[1]);
  label.box.box = {columns[2], columns[3], columns[4], columns[5]};
  label.box.score = category == 0 ? 0 : columns[6];
  label.category = kCategories[static_cast<std::size_t>(category)];
  label.truncated = columns[8] > 0;
  label.occlusion = columns[9] <= 0   ? Occlusion::kNone
                    : columns[9] == 1 ? Occlusion::kPartial
                                      : Occlusion::kHeavy;
  return label;
}

void ReadTruth(Recording& recording) {
  const fs::path file = AnnotationFile(recording.path);
  // The test-challenge parts come without.
  if (!fs::exists(file)) return;
  recording.labelling = Labelling::kObjects;
  int without_area = 0;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    const std::vector<double> columns = ParseColumns(file, line, text, 10, 10);
    CheckFrame(recording, file, line, columns[0]);
    const Label label = ParseLabel(file, line, columns);
    if (HasArea(file, line, label.box.box)) {
      recording.labels.push_back(label);
    } else {
      ++without_area;
    }
  });
  NoteWithoutArea(recording, file, without_area);
}

}  // namespace

const LayoutReader kVisDroneReader = {Recognises, Locate, ReadTruth};

}  // namespace windhover::replay
