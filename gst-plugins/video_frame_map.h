// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <stdexcept>
#include <string>

namespace windhover {

// A buffer mapped as a video frame, for as long as this lives. Strides and offsets come from its
// GstVideoMeta where it has one.
class VideoFrameMap {
 public:
  // Throws std::runtime_error where the buffer holds no frame of this format and size.
  VideoFrameMap(const GstVideoInfo& info, GstBuffer* buffer, GstMapFlags flags) {
    if (!gst_video_frame_map(&frame_, &info, buffer, flags)) {
      throw std::runtime_error("a buffer does not hold the video frame that its caps promise");
    }
    const int width = GST_VIDEO_FRAME_WIDTH(&frame_);
    const int height = GST_VIDEO_FRAME_HEIGHT(&frame_);
    if (width != GST_VIDEO_INFO_WIDTH(&info) || height != GST_VIDEO_INFO_HEIGHT(&info) ||
        GST_VIDEO_FRAME_FORMAT(&frame_) != GST_VIDEO_INFO_FORMAT(&info)) {
      gst_video_frame_unmap(&frame_);
      throw std::runtime_error("a buffer holds a frame of " + std::to_string(width) + "x" +
                               std::to_string(height) + " px, but its caps say " +
                               std::to_string(GST_VIDEO_INFO_WIDTH(&info)) + "x" +
                               std::to_string(GST_VIDEO_INFO_HEIGHT(&info)) + " px");
    }
  }
  ~VideoFrameMap() { gst_video_frame_unmap(&frame_); }
  VideoFrameMap(const VideoFrameMap&) = delete;
  VideoFrameMap& operator=(const VideoFrameMap&) = delete;

  const GstVideoFrame& frame() const { return frame_; }

 private:
  GstVideoFrame frame_;
};

}  // namespace windhover
