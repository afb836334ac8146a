// SPDX-License-Identifier: Apache-2.0
#include "replay/format/frame_source.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/sequence.h"

namespace windhover::replay {
namespace {

// Takes the size of the first frame where none is expected.
void CheckSize(const std::filesystem::path& file, const cv::Mat& frame, cv::Size& expected) {
  if (expected.empty()) expected = frame.size();
  if (frame.size() == expected) return;
  const auto text = [](const cv::Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
  };
  throw FormatError(file,
                    "is of " + text(frame.size()) + " px, but the sequence of " + text(expected));
}

class PictureFrames : public FrameSource {
 public:
  PictureFrames(std::vector<std::filesystem::path> pictures, cv::Size size)
      : pictures_(std::move(pictures)), size_(size) {}

  cv::Mat Next() override {
    if (next_ == pictures_.size()) return {};
    const std::filesystem::path& file = pictures_[next_++];
    cv::Mat frame = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (frame.empty()) throw FormatError(file, "the frame is missing or no picture");
    CheckSize(file, frame, size_);
    return frame;
  }
  int frames() const override { return static_cast<int>(pictures_.size()); }
  bool knows_frames() const override { return true; }

 private:
  std::vector<std::filesystem::path> pictures_;
  cv::Size size_;
  std::size_t next_ = 0;
};

class VideoFrames : public FrameSource {
 public:
  // FFmpeg alone: what else OpenCV tries where that fails looks for cameras and writes to stderr.
  VideoFrames(const std::filesystem::path& file, std::optional<int> known_frames, cv::Size size)
      : file_(file),
        capture_(file.string(), cv::CAP_FFMPEG),
        known_frames_(known_frames),
        size_(size) {
    if (!capture_.isOpened()) throw FormatError(file, "is no video that can be read");
  }

  cv::Mat Next() override {
    cv::Mat frame;
    if (!capture_.read(frame)) {
      if (known_frames_ && read_ < *known_frames_) Complain("ends after " + std::to_string(read_));
      return {};
    }
    if (known_frames_ && ++read_ > *known_frames_) Complain("goes on");
    CheckSize(file_, frame, size_);
    return frame;
  }
  // OpenCV makes large negative numbers of an unknown length.
  int frames() const override {
    return known_frames_.value_or(
        static_cast<int>(std::clamp(capture_.get(cv::CAP_PROP_FRAME_COUNT), 0.0, 1e8)));
  }
  bool knows_frames() const override { return known_frames_.has_value(); }

 private:
  [[noreturn]] void Complain(const std::string& what) const {
    throw FormatError(
        file_, what + ", but the sequence is of " + std::to_string(*known_frames_) + " frames");
  }

  std::filesystem::path file_;
  cv::VideoCapture capture_;
  std::optional<int> known_frames_;
  int read_ = 0;
  cv::Size size_;
};

std::unique_ptr<FrameSource> OpenSequence(const std::filesystem::path& folder) {
  const SequenceInfo info = ReadSequenceInfo(folder);
  const cv::Size size(info.width, info.height);
  if (const std::optional<std::filesystem::path> video = SequenceVideo(folder, info)) {
    return OpenVideo(*video, info.frames, size);
  }
  std::vector<std::filesystem::path> pictures;
  for (int i = 1; i <= info.frames; ++i) pictures.push_back(FramePath(folder, info, i));
  return OpenPictures(std::move(pictures), size);
}

}  // namespace

std::unique_ptr<FrameSource> OpenFrames(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw FormatError(path, "does not exist");
  if (std::filesystem::is_directory(path)) return OpenSequence(path);
  return std::make_unique<VideoFrames>(path, std::nullopt, cv::Size());
}

std::unique_ptr<FrameSource> OpenPictures(std::vector<std::filesystem::path> pictures,
                                          cv::Size size) {
  return std::make_unique<PictureFrames>(std::move(pictures), size);
}

std::unique_ptr<FrameSource> OpenVideo(const std::filesystem::path& file, int frames,
                                       cv::Size size) {
  return std::make_unique<VideoFrames>(file, frames, size);
}

}  // namespace windhover::replay
