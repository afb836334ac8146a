// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/picture_planes.h"

#include <Eigen/LU>
#include <stdexcept>
#include <string>

namespace windhover {

PicturePlanes::PicturePlanes(const GstVideoFrame& frame) {
  const int width = GST_VIDEO_FRAME_WIDTH(&frame);
  const int height = GST_VIDEO_FRAME_HEIGHT(&frame);
  const auto add = [&](int channels, int step, const cv::Scalar& black) {
    const auto index = static_cast<guint>(count_);
    planes_[count_++] = {cv::Mat((height + step - 1) / step, (width + step - 1) / step,
                                 CV_8UC(channels), GST_VIDEO_FRAME_PLANE_DATA(&frame, index),
                                 GST_VIDEO_FRAME_PLANE_STRIDE(&frame, index)),
                         step, black};
  };
  const bool full_range = frame.info.colorimetry.range == GST_VIDEO_COLOR_RANGE_0_255;
  const cv::Scalar black_luma(full_range ? 0.0 : 16.0);
  const cv::Scalar no_chroma(128.0, 128.0);
  switch (GST_VIDEO_FRAME_FORMAT(&frame)) {
    case GST_VIDEO_FORMAT_GRAY8:
      add(1, 1, 0.0);
      break;
    case GST_VIDEO_FORMAT_NV12:
      add(1, 1, black_luma);
      add(2, 2, no_chroma);
      break;
    case GST_VIDEO_FORMAT_I420:
      add(1, 1, black_luma);
      add(1, 2, no_chroma);
      add(1, 2, no_chroma);
      break;
    case GST_VIDEO_FORMAT_BGR:
    case GST_VIDEO_FORMAT_BGRx:
    case GST_VIDEO_FORMAT_RGB:
    case GST_VIDEO_FORMAT_RGBx:
      add(GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0), 1, {0.0, 0.0, 0.0, 255.0});
      break;
    default:
      throw std::invalid_argument(std::string("cannot warp the video format ") +
                                  gst_video_format_to_string(GST_VIDEO_FRAME_FORMAT(&frame)));
  }
}

Eigen::Matrix3d InPlane(const Eigen::Matrix3d& b_from_a, int step) {
  const double offset = 0.5 * (step - 1);
  Eigen::Matrix3d frame_from_plane;
  frame_from_plane << step, 0.0, offset, 0.0, step, offset, 0.0, 0.0, 1.0;
  return frame_from_plane.inverse() * b_from_a * frame_from_plane;
}

}  // namespace windhover
