// SPDX-License-Identifier: Apache-2.0
#include "replay/render/compression.h"

#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <cstring>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace windhover::replay {
namespace {

constexpr GstClockTime kPatience = 20 * GST_SECOND;  // for one picture; it takes milliseconds
// Luma rows, then the two chroma planes of half the size.
constexpr int kPlanes = 3;

int Even(int size) { return (size + 1) / 2 * 2; }

// Between a picture's packed I420 and a buffer's own strides.
template <typename Copy>
void ForEachRow(cv::Mat& packed, GstVideoFrame& frame, Copy&& copy) {
  std::uint8_t* row = packed.data;
  for (int plane = 0; plane < kPlanes; ++plane) {
    const int width = GST_VIDEO_FRAME_COMP_WIDTH(&frame, plane);
    auto* data = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane));
    for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&frame, plane); ++y) {
      copy(row, data + static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane),
           width);
      row += width;
    }
  }
}

}  // namespace

// A pipeline through which one picture at a time goes.
class Compression::Codec {
 public:
  Codec(int width, int height, int quantiser) {
    gst_init(nullptr, nullptr);
    gst_video_info_set_format(&info_, GST_VIDEO_FORMAT_I420, width, height);
    info_.fps_n = kRate;
    info_.fps_d = 1;
    const std::string text =
        "appsrc name=in format=time ! x264enc name=encoder tune=zerolatency speed-preset=veryfast "
        "threads=1 sliced-threads=false bframes=0 key-int-max=50 pass=quant quantizer=" +
        std::to_string(quantiser) +
        " option-string=scenecut=0 ! video/x-h264,profile=main,stream-format=byte-stream ! "
        "avdec_h264 max-threads=1 ! video/x-raw,format=I420 ! "
        "appsink name=out sync=false max-buffers=1";
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(text.c_str(), &error);
    if (error != nullptr) {
      const std::string reason = error->message;
      g_clear_error(&error);
      gst_clear_object(&pipeline_);
      throw std::runtime_error("no H.264 compression: " + reason);
    }
    in_ = gst_bin_get_by_name(GST_BIN(pipeline_), "in");
    out_ = gst_bin_get_by_name(GST_BIN(pipeline_), "out");
    GstCaps* caps = gst_video_info_to_caps(&info_);
    gst_app_src_set_caps(GST_APP_SRC(in_), caps);
    gst_caps_unref(caps);
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }
  ~Codec() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_clear_object(&in_);
    gst_clear_object(&out_);
    gst_clear_object(&pipeline_);
  }
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;

  // Replaces a packed I420 picture.
  void Pass(cv::Mat& packed) {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info_.size, nullptr);
    GstVideoFrame frame;
    gst_video_frame_map(&frame, &info_, buffer, GST_MAP_WRITE);
    ForEachRow(packed, frame, [](std::uint8_t* row, std::uint8_t* data, int width) {
      std::memcpy(data, row, static_cast<std::size_t>(width));
    });
    gst_video_frame_unmap(&frame);
    GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(count_, GST_SECOND, kRate);
    GST_BUFFER_DURATION(buffer) = GST_SECOND / kRate;
    ++count_;
    if (gst_app_src_push_buffer(GST_APP_SRC(in_), buffer) != GST_FLOW_OK) Fail();
    GstSample* sample = gst_app_sink_try_pull_sample(GST_APP_SINK(out_), kPatience);
    if (sample == nullptr) Fail();
    GstVideoInfo info;
    gst_video_info_from_caps(&info, gst_sample_get_caps(sample));
    gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ);
    ForEachRow(packed, frame, [](std::uint8_t* row, const std::uint8_t* data, int width) {
      std::memcpy(row, data, static_cast<std::size_t>(width));
    });
    gst_video_frame_unmap(&frame);
    gst_sample_unref(sample);
  }

 private:
  static constexpr int kRate = 25;  // a second; the codec asks, but nothing depends on it

  [[noreturn]] void Fail() {
    std::string reason = "no picture came out";
    GstBus* bus = gst_element_get_bus(pipeline_);
    if (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
      GError* error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      reason = error->message;
      g_clear_error(&error);
      gst_message_unref(message);
    }
    gst_object_unref(bus);
    throw std::runtime_error("H.264 compression failed: " + reason);
  }

  GstVideoInfo info_{};
  GstElement* pipeline_ = nullptr;
  GstElement* in_ = nullptr;
  GstElement* out_ = nullptr;
  std::uint64_t count_ = 0;
};

Compression::Compression(int width, int height, int quantiser)
    : width_(width),
      height_(height),
      codec_(std::make_unique<Codec>(Even(width), Even(height), quantiser)) {}

Compression::~Compression() = default;

cv::Mat Compression::Pass(const cv::Mat& picture) {
  // H.264's chroma needs even sizes: the last row and column are repeated and cut off again.
  cv::Mat padded;
  cv::copyMakeBorder(picture, padded, 0, Even(height_) - height_, 0, Even(width_) - width_,
                     cv::BORDER_REPLICATE);
  cv::Mat packed;
  cv::cvtColor(padded, packed, cv::COLOR_BGR2YUV_I420);
  codec_->Pass(packed);
  cv::cvtColor(packed, padded, cv::COLOR_YUV2BGR_I420);
  return padded(cv::Rect(0, 0, width_, height_)).clone();
}

}  // namespace windhover::replay
