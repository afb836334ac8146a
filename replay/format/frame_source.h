// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

namespace windhover::replay {

// Frames of a sequence folder, a list of pictures or a video file, one after the other. Never opens
// the truth.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The next frame, CV_8UC3 with blue first, or empty after the last one. Throws FormatError for a
  // frame that is missing, unreadable or of another size than the first.
  virtual cv::Mat Next() = 0;
  // How many there are, or 0 where the source does not say.
  virtual int frames() const = 0;
  // Whether that is certain. A video's word need not be: some estimate it, and one that breaks off
  // ends early and looks like any other.
  virtual bool knows_frames() const = 0;
};

// Of a sequence folder (sequence.h) or a video file. Throws FormatError where `path` is neither.
std::unique_ptr<FrameSource> OpenFrames(const std::filesystem::path& path);

// One picture a frame, in this order. `size` is that of every frame; empty: that of the first.
std::unique_ptr<FrameSource> OpenPictures(std::vector<std::filesystem::path> pictures,
                                          cv::Size size = {});

// Of a video that is known to have so many frames, of `size` where that is not empty: it is an
// error (FormatError, from Next) where it ends before or goes on after them.
std::unique_ptr<FrameSource> OpenVideo(const std::filesystem::path& file, int frames,
                                       cv::Size size = {});

}  // namespace windhover::replay
