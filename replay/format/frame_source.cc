// SPDX-License-Identifier: Apache-2.0
#include "replay/format/frame_source.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/sequence.h"

namespace windhover::replay {
namespace {

class SequenceFrames : public FrameSource {
 public:
  explicit SequenceFrames(std::filesystem::path folder)
      : folder_(std::move(folder)), info_(ReadSequenceInfo(folder_)) {}

  cv::Mat Next() override {
    if (next_ > info_.frames) return {};
    const std::filesystem::path file = FramePath(folder_, info_, next_++);
    cv::Mat frame = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (frame.empty()) throw FormatError(file, "the frame is missing or no picture");
    if (frame.cols != info_.width || frame.rows != info_.height) {
      throw FormatError(file, "is " + std::to_string(frame.cols) + "x" +
                                  std::to_string(frame.rows) + ", but seqinfo.ini says " +
                                  std::to_string(info_.width) + "x" + std::to_string(info_.height));
    }
    return frame;
  }
  int frames() const override { return info_.frames; }
  bool knows_frames() const override { return true; }

 private:
  std::filesystem::path folder_;
  SequenceInfo info_;
  int next_ = 1;
};

class VideoFrames : public FrameSource {
 public:
  // FFmpeg alone: what else OpenCV tries where that fails looks for cameras and writes to stderr.
  explicit VideoFrames(const std::filesystem::path& file)
      : file_(file), capture_(file.string(), cv::CAP_FFMPEG) {
    if (!capture_.isOpened()) throw FormatError(file, "is no video that can be read");
  }

  cv::Mat Next() override {
    cv::Mat frame;
    if (!capture_.read(frame)) return {};
    if (size_.empty()) size_ = frame.size();
    if (size_ != frame.size()) throw FormatError(file_, "the size of the frames changes");
    return frame;
  }
  // OpenCV makes large negative numbers of an unknown length.
  int frames() const override {
    return static_cast<int>(std::clamp(capture_.get(cv::CAP_PROP_FRAME_COUNT), 0.0, 1e8));
  }
  bool knows_frames() const override { return false; }

 private:
  std::filesystem::path file_;
  cv::VideoCapture capture_;
  cv::Size size_;
};

}  // namespace

std::unique_ptr<FrameSource> OpenFrames(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw FormatError(path, "does not exist");
  if (std::filesystem::is_directory(path)) return std::make_unique<SequenceFrames>(path);
  return std::make_unique<VideoFrames>(path);
}

}  // namespace windhover::replay
