// SPDX-License-Identifier: Apache-2.0
// Videos and pictures without a set: a video file, or a folder with one, no other and no folders;
// beside the video perhaps NAME_groundtruth.txt with the box of one target in each line, as in
// UAV123. A folder of numbered pictures.
#include <opencv2/videoio.hpp>

#include "replay/format/format_error.h"
#include "replay/readers/layout_reader.h"
#include "replay/readers/target_boxes.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

// Fewer are no recording.
constexpr int kLeastPictures = 2;

fs::path VideoOf(const fs::path& path) {
  return fs::is_directory(path) ? ListVideos(path).front() : path;
}

fs::path TargetFile(const fs::path& video) {
  return video.parent_path() / (video.stem().string() + "_groundtruth.txt");
}

bool HoldsFolders(const fs::path& path) {
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.is_directory() && entry.path().filename().string().front() != '.') return true;
  }
  return false;
}

bool RecognisesVideo(const fs::path& path) {
  if (!fs::is_directory(path)) return IsVideo(path);
  return ListVideos(path).size() == 1 && !HoldsFolders(path);
}

Recording LocateVideo(const fs::path& path) {
  const fs::path video = VideoOf(path);
  const cv::VideoCapture capture(video.string(), cv::CAP_FFMPEG);
  if (!capture.isOpened()) throw FormatError(video, "is no video that can be read");
  Recording recording;
  recording.path = path;
  recording.name = video.stem().string();
  recording.layout = "video";
  recording.width = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH));
  recording.height = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT));
  recording.frames = OpenFrames(video)->frames();
  recording.knows_frames = false;
  const double rate = capture.get(cv::CAP_PROP_FPS);
  if (rate > 0 && rate < 1e5) recording.frame_rate_hz = rate;
  recording.open_frames = [video] { return OpenFrames(video); };
  return recording;
}

void ReadVideoTruth(Recording& recording) {
  const fs::path video = VideoOf(recording.path);
  const fs::path file = TargetFile(video);
  if (!fs::exists(file)) return;
  recording.layout = "video with one target";
  const std::vector<std::optional<Box>> boxes = ReadTargetBoxes(file);
  UseTargetBoxes(recording, file, boxes);
  // The video's own word may be an estimate. Whether the lines are right shows in reading it.
  recording.frames = static_cast<int>(boxes.size());
  recording.knows_frames = true;
  recording.open_frames = [video, frames = recording.frames] { return OpenVideo(video, frames); };
}

bool RecognisesPictures(const fs::path& path) {
  if (!fs::is_directory(path)) return false;
  int numbered = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    const std::string stem = entry.path().stem().string();
    if (IsPicture(entry.path()) && stem.back() >= '0' && stem.back() <= '9') ++numbered;
  }
  return numbered >= kLeastPictures;
}

Recording LocateNumbered(const fs::path& path) {
  return LocatePictures(path, "pictures", ListNumberedPictures(path));
}

void ReadNothing(Recording&) {}

}  // namespace

const LayoutReader kVideoReader = {RecognisesVideo, LocateVideo, ReadVideoTruth};
const LayoutReader kPicturesReader = {RecognisesPictures, LocateNumbered, ReadNothing};

}  // namespace windhover::replay
