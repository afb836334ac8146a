// SPDX-License-Identifier: Apache-2.0
#include "replay/readers/recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/readers/layout_reader.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

// The first that recognises a recording reads it: from what only one layout has to what many have.
constexpr std::array<const LayoutReader*, 9> kReaders = {
    &kMotChallengeReader, &kCdnetReader,  &kPesmodReader, &kVisDroneReader, &kUavdtMotReader,
    &kUavdtSotReader,     &kUav123Reader, &kVideoReader,  &kPicturesReader};
// Folders below a dataset's at which recordings are looked for: UAV123/data_seq/UAV123/NAME and one
// more around it.
constexpr int kMostDepth = 4;

// With the last part a name.
fs::path Named(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

const LayoutReader* FindReader(const fs::path& path) {
  for (const LayoutReader* reader : kReaders) {
    if (reader->recognises(path)) return reader;
  }
  return nullptr;
}

Recording Open(const fs::path& given, bool with_truth) {
  if (!fs::exists(given)) throw FormatError(given, "does not exist");
  const fs::path path = Named(given);
  const LayoutReader* reader = FindReader(path);
  if (reader == nullptr) {
    throw FormatError(given, "is no sequence, no video and no recording of a set that is known");
  }
  Recording recording = reader->locate(path);
  if (with_truth) reader->read_truth(recording);
  return recording;
}

// UAV123 keeps several recordings in one folder of pictures; the annotations tell them apart.
bool IsUav123(const fs::path& folder) {
  return fs::is_directory(folder / "anno") && fs::is_directory(folder / "data_seq");
}

void Collect(const fs::path& path, int depth, std::vector<fs::path>& found) {
  if (FindReader(path) != nullptr) {
    found.push_back(path);
    return;
  }
  if (!fs::is_directory(path)) return;
  const bool annotations_only = IsUav123(path);
  const std::vector<fs::path> videos = ListVideos(path);
  found.insert(found.end(), videos.begin(), videos.end());
  if (depth == 0) return;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(annotations_only ? path / "anno" : path)) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.') continue;
    if (entry.is_directory()) Collect(entry.path(), depth - 1, found);
    if (entry.path().extension() == ".txt" && kUav123Reader.recognises(entry.path())) {
      found.push_back(entry.path());
    }
  }
}

}  // namespace

std::vector<LabelledBox> Recording::Truth() const {
  std::vector<LabelledBox> boxes;
  boxes.reserve(labels.size());
  for (const Label& label : labels) boxes.push_back(label.box);
  return boxes;
}

Recording OpenRecording(const fs::path& path) { return Open(path, true); }

Recording OpenRecordingWithoutTruth(const fs::path& path) { return Open(path, false); }

std::vector<fs::path> FindRecordings(const fs::path& path) {
  if (!fs::exists(path)) throw FormatError(path, "does not exist");
  std::vector<fs::path> found;
  Collect(Named(path), kMostDepth, found);
  std::sort(found.begin(), found.end());
  return found;
}

Recording LocatePictures(const fs::path& path, const std::string& layout,
                         NumberedPictures pictures) {
  if (pictures.files.empty()) throw FormatError(path, "holds no numbered pictures");
  const cv::Mat first = cv::imread(pictures.files.front().string(), cv::IMREAD_COLOR);
  if (first.empty()) throw FormatError(pictures.files.front(), "is no picture that can be read");
  Recording recording;
  recording.path = path;
  recording.name = path.filename().string();
  recording.layout = layout;
  recording.width = first.cols;
  recording.height = first.rows;
  recording.frames = static_cast<int>(pictures.files.size());
  recording.open_frames = [files = std::move(pictures.files), size = first.size()] {
    return OpenPictures(files, size);
  };
  return recording;
}

void CheckFrame(const Recording& recording, const fs::path& file, std::size_t line, double frame) {
  if (frame != std::floor(frame) || frame < 1) {
    throw FormatError(file, line, "the frame number must be whole and from 1");
  }
  if (frame > recording.frames) {
    throw FormatError(file, line,
                      "is of frame " + std::to_string(static_cast<std::int64_t>(frame)) +
                          ", but the recording has " + std::to_string(recording.frames));
  }
}

bool HasArea(const fs::path& file, std::size_t line, const Box& box) {
  if (box.width < 0 || box.height < 0) {
    throw FormatError(file, line, "width and height must not be below 0");
  }
  return box.width > 0 && box.height > 0;
}

void NoteWithoutArea(Recording& recording, const fs::path& file, int boxes) {
  if (boxes == 0) return;
  recording.notes.push_back(file.filename().string() + ": " + std::to_string(boxes) +
                            " boxes have no area and are left out");
}

}  // namespace windhover::replay
