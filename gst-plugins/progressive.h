// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <stdexcept>

namespace windhover {

// The video cannot be worked on as it comes. The text says what to do about it.
class UnsupportedVideo : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The two fields of an interlaced frame see the ground at two times: no homography holds for both.
// Throws UnsupportedVideo where the caps say that frames are interlaced. Mixed video passes, as
// many decoders say mixed of frames that are all progressive.
void RequireProgressive(const GstVideoInfo& info);

// Throws UnsupportedVideo where the video is mixed and this frame is flagged as interlaced.
void RequireProgressive(const GstVideoInfo& info, GstBuffer* frame);

}  // namespace windhover
