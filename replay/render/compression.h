// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>

namespace windhover::replay {

// What H.264 leaves of pictures: each is encoded by x264 on one thread, without looking ahead, and
// decoded again. The same pictures in the same order give the same bits, and no picture depends on
// a later one. Through GStreamer's elements x264enc and avdec_h264.
class Compression {
 public:
  // `quantiser` 1 (best) to 51, the same for all pictures. Throws std::runtime_error where the
  // elements are missing or refuse to start.
  Compression(int width, int height, int quantiser);
  ~Compression();
  Compression(const Compression&) = delete;
  Compression& operator=(const Compression&) = delete;

  // `picture` is CV_8UC3, blue first, of the stated size; so is what returns. Throws
  // std::runtime_error where the codec fails.
  cv::Mat Pass(const cv::Mat& picture);

 private:
  class Codec;

  int width_;
  int height_;
  std::unique_ptr<Codec> codec_;
};

}  // namespace windhover::replay
