// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/progressive.h"

#include <string>

namespace windhover {
namespace {

[[noreturn]] void Refuse(const std::string& what) {
  throw UnsupportedVideo(what +
                         ": its two fields see the ground at two times. Put 'deinterlace' before "
                         "whregister.");
}

}  // namespace

void RequireProgressive(const GstVideoInfo& info) {
  const GstVideoInterlaceMode mode = GST_VIDEO_INFO_INTERLACE_MODE(&info);
  if (mode == GST_VIDEO_INTERLACE_MODE_PROGRESSIVE || mode == GST_VIDEO_INTERLACE_MODE_MIXED) {
    return;
  }
  Refuse("The video is interlaced (" + std::to_string(GST_VIDEO_INFO_WIDTH(&info)) + "x" +
         std::to_string(GST_VIDEO_INFO_HEIGHT(&info)) +
         " px, interlace-mode=" + gst_video_interlace_mode_to_string(mode) + ")");
}

void RequireProgressive(const GstVideoInfo& info, GstBuffer* frame) {
  if (GST_VIDEO_INFO_INTERLACE_MODE(&info) != GST_VIDEO_INTERLACE_MODE_MIXED ||
      !GST_BUFFER_FLAG_IS_SET(frame, GST_VIDEO_BUFFER_FLAG_INTERLACED)) {
    return;
  }
  Refuse("A frame of the video is interlaced (" + std::to_string(GST_VIDEO_INFO_WIDTH(&info)) +
         "x" + std::to_string(GST_VIDEO_INFO_HEIGHT(&info)) + " px, interlace-mode=mixed)");
}

}  // namespace windhover
