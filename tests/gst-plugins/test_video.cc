// SPDX-License-Identifier: Apache-2.0
#include "tests/gst-plugins/test_video.h"

#include <Eigen/LU>
#include <algorithm>

#include "gst-plugins/video_frame_map.h"
#include "service/vision/homography.h"

namespace windhover {
namespace {

constexpr int kExtraLineBytes = 13;
constexpr int kPlaneGapBytes = 37;

void AddPaddedMeta(GstBuffer* buffer, const GstVideoInfo& info) {
  gsize offsets[GST_VIDEO_MAX_PLANES] = {};
  gint strides[GST_VIDEO_MAX_PLANES] = {};
  gsize size = 0;
  for (guint plane = 0; plane < GST_VIDEO_INFO_N_PLANES(&info); ++plane) {
    strides[plane] = GST_VIDEO_INFO_PLANE_STRIDE(&info, plane) + kExtraLineBytes;
    offsets[plane] = size + kPlaneGapBytes;
    const int lines =
        plane == 0 ? GST_VIDEO_INFO_HEIGHT(&info) : (GST_VIDEO_INFO_HEIGHT(&info) + 1) / 2;
    size = offsets[plane] + static_cast<gsize>(strides[plane]) * lines;
  }
  gst_buffer_append_memory(buffer, gst_allocator_alloc(nullptr, size, nullptr));
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(&info),
                                 GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info),
                                 GST_VIDEO_INFO_N_PLANES(&info), offsets, strides);
}

}  // namespace

TestVideo::TestVideo(int width, int height, GstVideoFormat format, Layout layout)
    : layout_(layout), gray_(backend_->MakeImage<std::uint8_t>(width, height)) {
  gst_video_info_set_format(&info_, format, width, height);
}

std::string TestVideo::Caps(bool with_framerate) const {
  return std::string("video/x-raw,format=") +
         gst_video_format_to_string(GST_VIDEO_INFO_FORMAT(&info_)) +
         ",width=" + std::to_string(GST_VIDEO_INFO_WIDTH(&info_)) +
         ",height=" + std::to_string(GST_VIDEO_INFO_HEIGHT(&info_)) +
         ",framerate=" + (with_framerate ? "25/1" : "0/1");
}

Eigen::Matrix3d TestVideo::GroundFromFrame(int t) const {
  if (camera_) return camera_(t);
  return CameraMotion(gray_.width(), gray_.height(), 0.004 * t, 1.0, 1.3 * t, -0.7 * t);
}

Eigen::Vector2d TestVideo::ObjectInFrame(int t) const {
  if (camera_) return {-1e3, -1e3};
  const Eigen::Vector2d on_ground(0.3 * gray_.width() + 2.2 * t, 0.4 * gray_.height() + 0.2 * t);
  return Project(InverseHomography(GroundFromFrame(t)), on_ground);
}

const GrayImage& TestVideo::Gray(int t) {
  const Eigen::Vector2d object = ObjectInFrame(t);
  ground_.Render(GroundFromFrame(t), 1.0, static_cast<std::uint32_t>(t), gray_,
                 [&](int x, int y, double value) {
                   const bool inside = x >= object.x() && x < object.x() + kObjectSide &&
                                       y >= object.y() && y < object.y() + kObjectSide;
                   return inside ? 255.0 : std::min(value, 190.0);
                 });
  return gray_;
}

BufferPtr TestVideo::MakeBuffer(int t) {
  BufferPtr buffer(layout_ == Layout::kTight
                       ? gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info_), nullptr)
                       : gst_buffer_new());
  if (layout_ == Layout::kWithMeta) AddPaddedMeta(buffer.get(), info_);
  GST_BUFFER_PTS(buffer.get()) = kFirstPts + t * kFrameTime;
  GST_BUFFER_DURATION(buffer.get()) = kFrameTime;
  GST_BUFFER_OFFSET(buffer.get()) = static_cast<guint64>(t);
  return buffer;
}

void TestVideo::Fill(GstBuffer* buffer, const GrayImage* gray) {
  gst_buffer_memset(buffer, 0, 0x5a, gst_buffer_get_size(buffer));
  const VideoFrameMap map(info_, buffer, GST_MAP_WRITE);
  const GstVideoFrame& frame = map.frame();
  const bool is_rgb = GST_VIDEO_INFO_IS_RGB(&info_);
  const int low_byte = GST_VIDEO_INFO_FORMAT(&info_) == GST_VIDEO_FORMAT_GRAY16_BE ? 1 : 0;
  const bool is_gray16 =
      low_byte == 1 || GST_VIDEO_INFO_FORMAT(&info_) == GST_VIDEO_FORMAT_GRAY16_LE;
  for (int component = 0; component < static_cast<int>(GST_VIDEO_FRAME_N_COMPONENTS(&frame));
       ++component) {
    auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, component));
    const int stride = GST_VIDEO_FRAME_COMP_STRIDE(&frame, component);
    const int step = GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component);
    const bool is_grey = is_rgb || component == 0;
    for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&frame, component); ++y) {
      for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&frame, component); ++x) {
        const int value = !is_grey ? 128 : gray != nullptr ? gray->Read().at(x, y) : 0;
        std::uint8_t* pixel = data + y * stride + x * step;
        if (!is_gray16) {
          *pixel = static_cast<std::uint8_t>(value);
          continue;
        }
        // Byte by byte, for strides may be odd.
        const int thermal = kThermalBlack + kThermalGain * value;
        pixel[low_byte] = static_cast<std::uint8_t>(thermal & 0xFF);
        pixel[1 - low_byte] = static_cast<std::uint8_t>(thermal >> 8);
      }
    }
  }
}

BufferPtr TestVideo::Frame(int t) {
  BufferPtr buffer = MakeBuffer(t);
  Fill(buffer.get(), &Gray(t));
  return buffer;
}

BufferPtr TestVideo::Black(int t) {
  BufferPtr buffer = MakeBuffer(t);
  Fill(buffer.get(), nullptr);
  return buffer;
}

}  // namespace windhover
