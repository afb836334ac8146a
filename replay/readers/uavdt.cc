// SPDX-License-Identifier: Apache-2.0
// UAVDT (Du et al., "The Unmanned Aerial Vehicle Benchmark: Object Detection and Tracking", ECCV
// 2018; the README of its UAV-benchmark-MOTD_v1.0 toolkit). 30 frames a second.
// MOT: UAV-benchmark-M/M0101/img000001.jpg; in UAV-benchmark-MOTD_v1.0/GT/ or GT/ M0101_gt.txt
// (frame from 1, id, left, top, width, height, a flag that is 0 for what does not count, two
// columns without meaning), M0101_gt_ignore.txt (the same for regions that were not labelled) where
// there are such, and M0101_gt_whole.txt (the same objects with truncation, 1 for none, occlusion,
// 1 none, 2 large, 3 medium, 4 small, and category in columns 7 to 9). SOT:
// UAV-benchmark-S/S0101/img000001.jpg and UAV-benchmark-SOT_v1.0/anno/S0101_gt.txt, the target's
// left, top, width and height in a line for each frame. Pixels from 0: boxes at 0 occur.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "replay/readers/layout_reader.h"
#include "replay/readers/target_boxes.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 30;
constexpr std::array<std::string_view, 4> kCategories = {"", "car", "truck", "bus"};

// "M0101" or "S0101": a letter and four digits.
bool IsNamed(const fs::path& path, char letter) {
  const std::string name = path.filename().string();
  return name.size() == 5 && name.front() == letter &&
         std::all_of(name.begin() + 1, name.end(),
                     [](unsigned char digit) { return std::isdigit(digit) != 0; });
}

// NAME_gt.txt in the first of the folders that has it: beside the pictures' folder, in it, or in
// the toolkit beside it.
std::optional<fs::path> FindTruth(const fs::path& path, const fs::path& toolkit,
                                  const char* folder) {
  const fs::path set = path.parent_path();
  for (const fs::path& place : {set.parent_path() / toolkit / folder, set.parent_path() / folder,
                                set / toolkit / folder, set / folder}) {
    const fs::path file = place / (path.filename().string() + "_gt.txt");
    if (fs::exists(file)) return file;
  }
  return std::nullopt;
}

std::optional<fs::path> MotTruth(const fs::path& path) {
  return FindTruth(path, "UAV-benchmark-MOTD_v1.0", "GT");
}

std::optional<fs::path> SotTruth(const fs::path& path) {
  return FindTruth(path, "UAV-benchmark-SOT_v1.0", "anno");
}

bool RecognisesMot(const fs::path& path) {
  return IsNamed(path, 'M') && fs::is_directory(path) && MotTruth(path).has_value();
}

bool RecognisesSot(const fs::path& path) {
  return IsNamed(path, 'S') && fs::is_directory(path) && SotTruth(path).has_value();
}

Recording Locate(const fs::path& path, const char* layout) {
  Recording recording = LocatePictures(path, layout, ListNumberedPictures(path));
  recording.frame_rate_hz = kRateHz;
  return recording;
}

Recording LocateMot(const fs::path& path) { return Locate(path, "UAVDT MOT"); }
Recording LocateSot(const fs::path& path) { return Locate(path, "UAVDT SOT"); }

struct Attributes {
  std::string_view category;
  Occlusion occlusion = Occlusion::kNone;
  bool truncated = false;
};
// By frame and id.
using AttributeTable = std::map<std::pair<double, double>, Attributes>;

AttributeTable ReadAttributes(const fs::path& file) {
  AttributeTable table;
  if (!fs::exists(file)) return table;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    const std::vector<double> columns = ParseColumns(file, line, text, 9, 9);
    const double category = columns[8];
    if (category != std::floor(category) || category < 1 ||
        category >= static_cast<double>(kCategories.size())) {
      throw FormatError(file, line, "there is no category " + NumberText(category, 6));
    }
    table[{columns[0], columns[1]}] = {kCategories[static_cast<std::size_t>(category)],
                                       columns[7] <= 1   ? Occlusion::kNone
                                       : columns[7] == 2 ? Occlusion::kHeavy
                                                         : Occlusion::kPartial,
                                       columns[6] > 1};
  });
  return table;
}

// Calls add(columns, box) for each line that has a box with an area.
template <typename Add>
void ForEachBox(Recording& recording, const fs::path& file, Add&& add) {
  int without_area = 0;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    const std::vector<double> columns = ParseColumns(file, line, text, 7, 9);
    CheckFrame(recording, file, line, columns[0]);
    if (columns[1] != std::floor(columns[1])) throw FormatError(file, line, "the id must be whole");
    LabelledBox box;
    box.frame = static_cast<int>(columns[0]);
    box.box = {columns[2], columns[3], columns[4], columns[5]};
    if (HasArea(file, line, box.box)) {
      add(columns, box);
    } else {
      ++without_area;
    }
  });
  NoteWithoutArea(recording, file, without_area);
}

void ReadMotTruth(Recording& recording) {
  const fs::path file = MotTruth(recording.path).value();
  const auto beside = [&](const char* ending) {
    return file.parent_path() / (recording.name + ending);
  };
  recording.labelling = Labelling::kObjects;
  const AttributeTable attributes = ReadAttributes(beside("_gt_whole.txt"));
  ForEachBox(recording, file, [&](const std::vector<double>& columns, LabelledBox box) {
    box.id = static_cast<std::int64_t>(columns[1]);
    box.score = columns[6] == 0 ? 0 : 1;
    Label label = {box, "", Occlusion::kNone, false};
    if (const auto found = attributes.find({columns[0], columns[1]}); found != attributes.end()) {
      label.category = found->second.category;
      label.occlusion = found->second.occlusion;
      label.truncated = found->second.truncated;
    }
    recording.labels.push_back(std::move(label));
  });
  const fs::path ignored = beside("_gt_ignore.txt");
  if (!fs::exists(ignored)) return;
  ForEachBox(recording, ignored, [&](const std::vector<double>&, LabelledBox box) {
    box.score = 0;
    recording.labels.push_back({box, "ignored region", Occlusion::kNone, false});
  });
}

void ReadSotTruth(Recording& recording) {
  const fs::path file = SotTruth(recording.path).value();
  UseTargetBoxes(recording, file, ReadTargetBoxes(file));
}

}  // namespace

const LayoutReader kUavdtMotReader = {RecognisesMot, LocateMot, ReadMotTruth};
const LayoutReader kUavdtSotReader = {RecognisesSot, LocateSot, ReadSotTruth};

}  // namespace windhover::replay
