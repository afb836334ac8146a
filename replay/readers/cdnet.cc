// SPDX-License-Identifier: Apache-2.0
// CDnet 2014, category PTZ and any other (changedetection.net; Wang et al., "CDnet 2014: An
// Expanded Change Detection Benchmark Dataset", CVPRW 2014): continuousPan/input/in000001.jpg,
// groundtruth/gt000001.png (mask_boxes.h) and temporalROI.txt with the first and the last picture
// that is judged. What lies outside of that does not count.
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "replay/readers/layout_reader.h"
#include "replay/readers/mask_boxes.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

bool Recognises(const fs::path& path) {
  return fs::is_directory(path / "input") && fs::is_directory(path / "groundtruth");
}

Recording Locate(const fs::path& path) {
  return LocatePictures(path, "CDnet", ListNumberedPictures(path / "input"));
}

struct JudgedPictures {
  int first = 0;
  int last = 0;
};

JudgedPictures ReadJudged(const fs::path& file) {
  JudgedPictures judged;
  ForEachLine(file, [&](std::size_t line, std::string_view text) {
    const std::vector<double> columns = ParseColumns(file, line, text, 2, 2);
    for (const double column : columns) {
      if (column != std::floor(column) || column < 1 || column > 1e8) {
        throw FormatError(file, line, "expected two picture numbers from 1");
      }
    }
    judged = {static_cast<int>(columns[0]), static_cast<int>(columns[1])};
  });
  if (judged.first == 0 || judged.last < judged.first) {
    throw FormatError(file, "must name a first and a last picture");
  }
  return judged;
}

// gt000123.png for in000123.jpg.
fs::path MaskOf(const fs::path& folder, const fs::path& picture) {
  const std::string stem = picture.stem().string();
  return folder / "groundtruth" /
         ("gt" + stem.substr(stem.find_last_not_of("0123456789") + 1) + ".png");
}

cv::Mat ReadMask(const Recording& recording, const fs::path& file) {
  const cv::Mat mask = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (mask.empty()) throw FormatError(file, "the mask is missing or no picture");
  if (mask.cols != recording.width || mask.rows != recording.height) {
    throw FormatError(file, "is not of the size of the pictures in input");
  }
  return mask;
}

void ReadTruth(Recording& recording) {
  recording.labelling = Labelling::kMovers;
  recording.labels_move = true;
  const JudgedPictures judged = ReadJudged(recording.path / "temporalROI.txt");
  const NumberedPictures pictures = ListNumberedPictures(recording.path / "input");
  const int last = pictures.first_number + recording.frames - 1;
  if (judged.first < pictures.first_number || judged.last > last) {
    throw FormatError(recording.path / "temporalROI.txt",
                      "names pictures " + std::to_string(judged.first) + " to " +
                          std::to_string(judged.last) + ", but there are " +
                          std::to_string(pictures.first_number) + " to " + std::to_string(last));
  }
  for (int frame = 1; frame <= recording.frames; ++frame) {
    const int number = pictures.first_number + frame - 1;
    if (number >= judged.first && number <= judged.last) {
      const fs::path file = MaskOf(recording.path, pictures.files[frame - 1]);
      for (Label& label : BoxesOfMask(file, ReadMask(recording, file), frame)) {
        recording.labels.push_back(std::move(label));
      }
      continue;
    }
    Label label;
    label.box.frame = frame;
    label.box.box = {0, 0, static_cast<double>(recording.width),
                     static_cast<double>(recording.height)};
    label.box.score = 0;
    label.category = "not judged";
    recording.labels.push_back(label);
  }
}

}  // namespace

const LayoutReader kCdnetReader = {Recognises, Locate, ReadTruth};

}  // namespace windhover::replay
