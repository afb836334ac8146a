// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <memory>

#include "gpu-kernels/image.h"
#include "service/vision/gray_range.h"

namespace windhover {

// The raw video formats that the elements take, for caps strings; of 8 bits, and all.
#define WINDHOVER_8_BIT_FORMATS "GRAY8, NV12, I420, BGR, BGRx, RGB, RGBx"
#define WINDHOVER_VIDEO_FORMATS "{ " WINDHOVER_8_BIT_FORMATS ", GRAY16_LE, GRAY16_BE }"

// Copies the frame's luma to `gray`, which has the frame's size: the Y plane as it is, without a
// change of range, or 0.299 R + 0.587 G + 0.114 B rounded to the nearest (ITU-R BT.601). The frame
// is mapped for reading and of one of WINDHOVER_8_BIT_FORMATS; throws std::invalid_argument
// otherwise.
void ExtractLuma(const GstVideoFrame& frame, GrayImage& gray);

// The luma of the frames of a stream: as ExtractLuma, and of GRAY16 in a range that follows the
// pictures (service/vision/gray_range.h). Elements that read the same frames see the same luma.
class StreamLuma {
 public:
  // True where the range jumped: grey levels of this frame cannot be compared with those before.
  bool Extract(const GstVideoFrame& frame, GrayImage& gray);
  // The next frame has nothing to do with those before.
  void Reset();

 private:
  struct Automatic {
    GrayHistogram histogram;
    StreamGrayRange range;
    GrayTable table;
  };
  std::unique_ptr<Automatic> automatic_;  // from the first 16-bit frame on
};

}  // namespace windhover
