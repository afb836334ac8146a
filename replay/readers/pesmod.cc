// SPDX-License-Identifier: Apache-2.0
// PESMOD (Delibasoglu, "UAV images dataset for moving object detection from moving cameras",
// arXiv:2103.11460; github.com/mribrahim/PESMOD): Pexels-Welton/images/frame0001.jpg and
// annotations/frame0001.xml in Pascal VOC's form, an object "motion" for each that moves, without
// identities. Boxes are read as the set's own scorer does: xmin, ymin and the differences to xmax
// and ymax, from 0. A picture without a file shows nothing that moves.
#include <map>

#include "replay/format/format_error.h"
#include "replay/readers/layout_reader.h"
#include "replay/readers/voc_annotation.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

bool Recognises(const fs::path& path) {
  return fs::is_directory(path / "images") && fs::is_directory(path / "annotations");
}

Recording Locate(const fs::path& path) {
  Recording recording = LocatePictures(path, "PESMOD", ListNumberedPictures(path / "images"));
  return recording;
}

void AddLabels(Recording& recording, const fs::path& file, int frame) {
  const VocAnnotation annotation = ReadVoc(file);
  if ((annotation.width > 0 && annotation.width != recording.width) ||
      (annotation.height > 0 && annotation.height != recording.height)) {
    throw FormatError(file, "is of a picture of " + std::to_string(annotation.width) + "x" +
                                std::to_string(annotation.height) + " px, but the pictures have " +
                                std::to_string(recording.width) + "x" +
                                std::to_string(recording.height));
  }
  for (const VocObject& object : annotation.objects) {
    Label label;
    label.box.frame = frame;
    label.box.box = object.box;
    label.box.score = object.difficult ? 0 : 1;
    label.category = object.name;
    label.occlusion = object.occluded ? Occlusion::kPartial : Occlusion::kNone;
    label.truncated = object.truncated;
    recording.labels.push_back(label);
  }
}

void ReadTruth(Recording& recording) {
  recording.labelling = Labelling::kMovers;
  recording.labels_move = true;
  std::map<std::string, int> frame_of;
  const NumberedPictures pictures = ListNumberedPictures(recording.path / "images");
  for (std::size_t i = 0; i < pictures.files.size(); ++i) {
    frame_of[pictures.files[i].stem().string()] = static_cast<int>(i) + 1;
  }
  std::map<int, fs::path> annotations;
  for (const fs::directory_entry& entry : fs::directory_iterator(recording.path / "annotations")) {
    if (entry.path().extension() != ".xml") continue;
    const auto frame = frame_of.find(entry.path().stem().string());
    if (frame == frame_of.end())
      throw FormatError(entry.path(), "its picture is missing in images");
    annotations[frame->second] = entry.path();
  }
  for (const auto& [frame, file] : annotations) AddLabels(recording, file, frame);
  const std::size_t without = pictures.files.size() - annotations.size();
  if (without > 0) {
    recording.notes.push_back(std::to_string(without) +
                              " pictures have no annotation: nothing moves there");
  }
}

}  // namespace

const LayoutReader kPesmodReader = {Recognises, Locate, ReadTruth};

}  // namespace windhover::replay
