// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

namespace windhover::replay {

// Frames of a sequence folder or a video file, one after the other. Never opens the truth.
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

// Throws FormatError where `path` is neither.
std::unique_ptr<FrameSource> OpenFrames(const std::filesystem::path& path);

}  // namespace windhover::replay
