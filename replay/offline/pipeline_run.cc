// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/pipeline_run.h"

#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "service/gstreamer/messages.h"
#include "service/gstreamer/objects.h"
#include "service/gstreamer/start.h"

namespace windhover::replay {
namespace {

void SetProperties(GstElement* pipeline, const PipelineSettings& settings) {
  GstIterator* elements = gst_bin_iterate_elements(GST_BIN(pipeline));
  const auto set = [](const GValue* item, gpointer data) {
    auto* element = static_cast<GObject*>(g_value_get_object(item));
    // The queues and ends have properties of their own that may bear the same names.
    const GstElementFactory* factory = gst_element_get_factory(GST_ELEMENT(element));
    if (!g_str_has_prefix(GST_OBJECT_NAME(factory), "wh")) return;
    for (const auto& [name, value] : static_cast<const PipelineSettings*>(data)->options) {
      SetProperty(element, name, value);
    }
  };
  gst_iterator_foreach(elements, set, const_cast<PipelineSettings*>(&settings));
  gst_iterator_free(elements);
}

// The frame's planes as GStreamer lays them out, which may pad rows.
GstBuffer* MakeBuffer(const cv::Mat& frame, const GstVideoInfo& info) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info), nullptr);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  const std::uint8_t* from = frame.ptr();
  for (guint plane = 0; plane < GST_VIDEO_INFO_N_PLANES(&info); ++plane) {
    const int row_bytes =
        GST_VIDEO_INFO_COMP_WIDTH(&info, plane) * GST_VIDEO_INFO_COMP_PSTRIDE(&info, plane);
    for (int y = 0; y < GST_VIDEO_INFO_COMP_HEIGHT(&info, plane); ++y, from += row_bytes) {
      std::memcpy(map.data + GST_VIDEO_INFO_PLANE_OFFSET(&info, plane) +
                      static_cast<std::size_t>(y) * GST_VIDEO_INFO_PLANE_STRIDE(&info, plane),
                  from, row_bytes);
    }
  }
  gst_buffer_unmap(buffer, &map);
  return buffer;
}

// Whoever waits in the pipeline is let go before it goes itself.
struct StopAndUnref {
  void operator()(GstElement* pipeline) const {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }
};
using PipelinePtr = std::unique_ptr<GstElement, StopAndUnref>;

PipelinePtr BuildPipeline(const PipelineSettings& settings) {
  const std::string text =
      "appsrc name=source format=time block=true max-buffers=4 max-bytes=0 ! " + settings.elements +
      " ! fakesink name=sink sync=false";
  GError* error = nullptr;
  PipelinePtr pipeline(gst_parse_launch(text.c_str(), &error));
  if (error != nullptr) {
    const std::string message = error->message;
    g_error_free(error);
    throw std::runtime_error(message);
  }
  SetProperties(pipeline.get(), settings);
  return pipeline;
}

void PushFrames(GstElement* source, const std::vector<cv::Mat>& frames, double frame_rate_hz,
                const std::function<void(std::size_t)>& enter) {
  GstVideoInfo info;
  const cv::Mat& first = frames.front();
  if (first.channels() == 3) {
    gst_video_info_set_format(&info, GST_VIDEO_FORMAT_BGR, first.cols, first.rows);
  } else {
    gst_video_info_set_format(&info, GST_VIDEO_FORMAT_I420, first.cols, first.rows * 2 / 3);
  }
  info.fps_n = static_cast<int>(std::lround(frame_rate_hz * 1000));
  info.fps_d = 1000;
  GstCaps* caps = gst_video_info_to_caps(&info);
  gst_app_src_set_caps(GST_APP_SRC(source), caps);
  gst_caps_unref(caps);
  const auto duration = static_cast<GstClockTime>(std::llround(GST_SECOND / frame_rate_hz));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    GstBuffer* buffer = MakeBuffer(frames[i], info);
    GST_BUFFER_PTS(buffer) = i * duration;
    GST_BUFFER_DURATION(buffer) = duration;
    if (enter) enter(i);
    if (gst_app_src_push_buffer(GST_APP_SRC(source), buffer) != GST_FLOW_OK) return;
  }
  gst_app_src_end_of_stream(GST_APP_SRC(source));
}

}  // namespace

void PlayThroughPipeline(const std::vector<cv::Mat>& frames, double frame_rate_hz,
                         const PipelineSettings& settings,
                         const std::function<void(GstBuffer*)>& leave,
                         const std::function<void(std::size_t)>& enter) {
  StartGStreamer();
  const PipelinePtr pipeline = BuildPipeline(settings);
  const ObjectPtr<GstElement> source(gst_bin_get_by_name(GST_BIN(pipeline.get()), "source"));
  const ObjectPtr<GstElement> sink(gst_bin_get_by_name(GST_BIN(pipeline.get()), "sink"));
  const ObjectPtr<GstPad> pad(gst_element_get_static_pad(sink.get(), "sink"));
  gst_pad_add_probe(
      pad.get(), GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad* at, GstPadProbeInfo* info, gpointer data) {
        try {
          (*static_cast<const std::function<void(GstBuffer*)>*>(data))(
              GST_PAD_PROBE_INFO_BUFFER(info));
        } catch (const std::exception& error) {
          GST_ELEMENT_ERROR(GST_PAD_PARENT(at), STREAM, FAILED, ("%s", error.what()), (nullptr));
        }
        return GST_PAD_PROBE_OK;
      },
      const_cast<std::function<void(GstBuffer*)>*>(&leave), nullptr);
  gst_element_set_state(pipeline.get(), GST_STATE_PLAYING);
  PushFrames(source.get(), frames, frame_rate_hz, enter);
  const ObjectPtr<GstBus> bus(gst_element_get_bus(pipeline.get()));
  const std::string failure = AwaitEnd(bus.get());
  if (!failure.empty()) throw std::runtime_error("the pipeline failed: " + failure);
}

}  // namespace windhover::replay
