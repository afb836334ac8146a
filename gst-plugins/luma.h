// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include "gpu-kernels/image.h"

namespace windhover {

// The raw video formats that the elements take, for caps strings.
#define WINDHOVER_VIDEO_FORMATS "{ GRAY8, NV12, I420, BGR, BGRx, RGB, RGBx }"

// Copies the frame's luma to `gray`, which has the frame's size: the Y plane as it is, without a
// change of range, or 0.299 R + 0.587 G + 0.114 B rounded to the nearest (ITU-R BT.601). The frame
// is mapped for reading and of one of WINDHOVER_VIDEO_FORMATS; throws std::invalid_argument
// otherwise.
void ExtractLuma(const GstVideoFrame& frame, GrayImage& gray);

}  // namespace windhover
