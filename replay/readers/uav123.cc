// SPDX-License-Identifier: Apache-2.0
// UAV123 (Mueller, Smith and Ghanem, "A Benchmark and Simulator for UAV Tracking", ECCV 2016):
// data_seq/UAV123/bird1/000001.jpg and anno/UAV123/bird1_2.txt, the target's left, top, width and
// height in a line for each frame, NaN where it is not in the picture. Several annotations may be
// of parts of one folder of pictures; where each begins and ends stands in configSeqs.m as
// struct('name','bird1_2','path','...','startFrame',775,'endFrame',1477,...), in a list for each
// set (seqUAV123, seqUAV20L, seqUAV123_10fps). The long set UAV20L has the pictures of UAV123. 30
// frames a second, or 10 in UAV123_10fps.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <string>

#include "replay/format/format_error.h"
#include "replay/readers/layout_reader.h"
#include "replay/readers/target_boxes.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

struct Part {
  fs::path annotation;
  fs::path pictures;
  int first = 0;  // numbers of the first and the last picture; 0: all of the folder
  int last = 0;
};

// What the list for `set` in configSeqs.m says of `name`: the folder of pictures, first and last.
struct Listed {
  std::string folder;
  int first = 0;
  int last = 0;
};

std::optional<Listed> FindListed(const fs::path& file, const std::string& set,
                                 const std::string& name) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  static const std::regex token_form(
      R"(seq(\w+)\s*=|'name'\s*,\s*'([^']*)'\s*,\s*'path'\s*,\s*'([^']*)'\s*,\s*'startFrame'\s*,\s*(\d{1,9})\s*,\s*'endFrame'\s*,\s*(\d{1,9}))");
  bool in_set = false;
  for (std::sregex_iterator token(text.begin(), text.end(), token_form), end; token != end;
       ++token) {
    const std::smatch& match = *token;
    if (match[1].matched) {
      in_set = match[1] == set;
    } else if (in_set && match[2] == name) {
      std::string folder = match[3];
      std::replace(folder.begin(), folder.end(), '\\', '/');
      while (!folder.empty() && folder.back() == '/') folder.pop_back();
      return Listed{fs::path(folder).filename().string(), std::stoi(match[4]), std::stoi(match[5])};
    }
  }
  return std::nullopt;
}

// "bird1_2" without "_2".
std::string WithoutPart(const std::string& name) {
  const std::size_t line = name.rfind('_');
  const bool numbered = line != std::string::npos && line + 1 < name.size() &&
                        name.find_first_not_of("0123456789", line + 1) == std::string::npos;
  return numbered ? name.substr(0, line) : name;
}

// `annotation` is ROOT/anno/SET/NAME.txt.
Part FindPart(const fs::path& annotation) {
  const std::string set = annotation.parent_path().filename().string();
  const std::string name = annotation.stem().string();
  const fs::path root = annotation.parent_path().parent_path().parent_path();
  fs::path pictures = root / "data_seq" / set;
  if (!fs::is_directory(pictures)) pictures = root / "data_seq" / "UAV123";
  for (const fs::path& folder : {root, root.parent_path()}) {
    if (const std::optional<Listed> listed = FindListed(folder / "configSeqs.m", set, name)) {
      return {annotation, pictures / listed->folder, listed->first, listed->last};
    }
  }
  const bool whole = fs::is_directory(pictures / name);
  return {annotation, pictures / (whole ? name : WithoutPart(name)), 0, 0};
}

// The annotation that `path` is or, as a folder of pictures, has: ROOT/data_seq/SET/NAME.
fs::path AnnotationOf(const fs::path& path) {
  if (path.extension() == ".txt") return path;
  const fs::path set = path.parent_path();
  return set.parent_path().parent_path() / "anno" / set.filename() /
         (path.filename().string() + ".txt");
}

bool Recognises(const fs::path& path) {
  const fs::path annotation = AnnotationOf(path);
  const fs::path anno = annotation.parent_path().parent_path();
  if (anno.filename() != "anno" || !fs::is_regular_file(annotation)) return false;
  if (path != annotation && path.parent_path().parent_path().filename() != "data_seq") return false;
  return fs::is_directory(anno.parent_path() / "data_seq") &&
         fs::is_directory(FindPart(annotation).pictures);
}

Recording Locate(const fs::path& path) {
  const Part part = FindPart(AnnotationOf(path));
  NumberedPictures pictures = ListNumberedPictures(part.pictures);
  if (part.first > 0) {
    const int before = part.first - pictures.first_number;
    const int count = part.last - part.first + 1;
    if (before < 0 || count < 1 || before + count > static_cast<int>(pictures.files.size())) {
      throw FormatError(part.pictures, "lacks pictures " + std::to_string(part.first) + " to " +
                                           std::to_string(part.last) + ", which " +
                                           part.annotation.stem().string() + " is of");
    }
    pictures.files.erase(pictures.files.begin() + before + count, pictures.files.end());
    pictures.files.erase(pictures.files.begin(), pictures.files.begin() + before);
  }
  Recording recording = LocatePictures(path, "UAV123", std::move(pictures));
  recording.name = part.annotation.stem().string();
  recording.frame_rate_hz = part.annotation.parent_path().filename() == "UAV123_10fps" ? 10 : 30;
  return recording;
}

void ReadTruth(Recording& recording) {
  const Part part = FindPart(AnnotationOf(recording.path));
  const std::vector<std::optional<Box>> boxes = ReadTargetBoxes(part.annotation);
  if (part.first == 0 && static_cast<int>(boxes.size()) != recording.frames) {
    throw FormatError(part.annotation,
                      "has " + std::to_string(boxes.size()) + " lines, but there are " +
                          std::to_string(recording.frames) + " pictures in " +
                          part.pictures.string() +
                          "; configSeqs.m, which says of which of them it is, is not there");
  }
  UseTargetBoxes(recording, part.annotation, boxes);
}

}  // namespace

const LayoutReader kUav123Reader = {Recognises, Locate, ReadTruth};

}  // namespace windhover::replay
