// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/pipeline.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace windhover {
namespace {

ObjectPtr<GstPad> StaticPad(GstElement* element, const char* name) {
  return ObjectPtr<GstPad>(gst_element_get_static_pad(element, name));
}

}  // namespace

Pipeline::Pipeline(const Source& source, const std::vector<std::string>& elements,
                   const std::string& video_path, std::function<void(GstBuffer*)> leave)
    : pipeline_(GST_ELEMENT(gst_object_ref_sink(gst_pipeline_new("windhover")))),
      leave_(std::move(leave)),
      missing_bytes_(source.missing_bytes) {
  // Passes pictures through unchanged where whregister takes them as they are.
  head_ = last_ = Add("videoconvert");
  for (const std::string& name : elements) {
    GstElement* element = Append(name);
    if (name == "whpublish") publish_ = element;
    if (name != "queue") ours_.push_back(element);
  }
  gst_pad_add_probe(
      StaticPad(head_, "sink").get(),
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM),
      [](GstPad* pad, GstPadProbeInfo* info, gpointer self) {
        return static_cast<Pipeline*>(self)->OnFrameIn(pad, info);
      },
      this, nullptr);
  gst_pad_add_probe(
      StaticPad(last_, "src").get(), GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer self) {
        return static_cast<Pipeline*>(self)->OnFrameOut(GST_PAD_PROBE_INFO_BUFFER(info));
      },
      this, nullptr);
  AddSource(source);
  if (video_path.empty()) {
    g_object_set(Append("fakesink"), "sync", FALSE, nullptr);
  } else {
    AddVideo(video_path);
  }
}

Pipeline::~Pipeline() { gst_element_set_state(pipeline_.get(), GST_STATE_NULL); }

GstElement* Pipeline::Add(const std::string& factory) {
  GstElement* element = gst_element_factory_make(factory.c_str(), nullptr);
  if (element == nullptr) {
    throw std::runtime_error(fmt::format("GStreamer's element {} is not installed", factory));
  }
  gst_bin_add(GST_BIN(pipeline_.get()), element);
  return element;
}

GstElement* Pipeline::Append(const std::string& factory) {
  GstElement* element = Add(factory);
  if (!gst_element_link(last_, element)) {
    throw std::runtime_error(fmt::format("GStreamer's element {} cannot be linked", factory));
  }
  return last_ = element;
}

void Pipeline::AddPictures(const Source& source) {
  GstElement* pictures = Add("multifilesrc");
  GstElement* decoder = Add(source.media_type == "image/png" ? "pngdec" : "jpegdec");
  int numerator = 0;
  int denominator = 1;
  gst_util_double_to_fraction(source.frame_rate_hz, &numerator, &denominator);
  GstCaps* caps = gst_caps_new_simple(source.media_type.c_str(), "framerate", GST_TYPE_FRACTION,
                                      numerator, denominator, nullptr);
  g_object_set(pictures, "location", source.pattern.c_str(), "index", 1, "start-index", 1,
               "stop-index", source.frames, "caps", caps, nullptr);
  gst_caps_unref(caps);
  gst_element_link_many(pictures, decoder, head_, nullptr);
  pattern_ = source.pattern;
  pictures_ = source.frames;
  length_ns_ = static_cast<std::int64_t>(source.frames * 1e9 / source.frame_rate_hz);
  gst_pad_add_probe(
      StaticPad(pictures, "src").get(), GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo*, gpointer self) {
        static_cast<Pipeline*>(self)->OnPicture();
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);
}

void Pipeline::AddSource(const Source& source) {
  if (source.uri.empty()) {
    AddPictures(source);
    return;
  }
  GstElement* decoder = Add("uridecodebin");
  g_object_set(decoder, "uri", source.uri.c_str(), nullptr);
  g_signal_connect(decoder, "pad-added",
                   G_CALLBACK(+[](GstElement*, GstPad* pad, Pipeline* self) { self->OnPad(pad); }),
                   this);
  g_signal_connect(decoder, "no-more-pads", G_CALLBACK(+[](GstElement*, Pipeline* self) {
                     if (gst_pad_is_linked(StaticPad(self->head_, "sink").get())) return;
                     GST_ELEMENT_ERROR(self->pipeline_.get(), STREAM, FORMAT,
                                       ("There is no video in it"), (nullptr));
                   }),
                   this);
}

void Pipeline::AddVideo(const std::string& path) {
  gst_pad_add_probe(
      StaticPad(last_, "src").get(), GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
      [](GstPad*, GstPadProbeInfo* info, gpointer self) {
        GstEvent* event = GST_PAD_PROBE_INFO_EVENT(info);
        if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
          GstCaps* caps = nullptr;
          gst_event_parse_caps(event, &caps);
          static_cast<Pipeline*>(self)->OnVideoCaps(caps);
        }
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);
  Append("queue");
  crop_ = Append("videocrop");
  Append("videoconvert");
  GstElement* format = Append("capsfilter");
  gst_util_set_object_arg(G_OBJECT(format), "caps", "video/x-raw,format=I420");
  GstElement* encoder = Append("x264enc");
  // Constant quality: the rate follows the pictures.
  for (const auto& [name, value] :
       {std::pair("pass", "quant"), {"quantizer", "23"}, {"speed-preset", "superfast"}}) {
    gst_util_set_object_arg(G_OBJECT(encoder), name, value);
  }
  Append("mp4mux");
  g_object_set(Append("filesink"), "location", path.c_str(), nullptr);
}

void Pipeline::Set(const std::string& name, const std::string& value) {
  for (GstElement* element : ours_) SetProperty(G_OBJECT(element), name, value);
}

void Pipeline::SetState(GstState state) { gst_element_set_state(pipeline_.get(), state); }

GstBus* Pipeline::bus() const { return GST_ELEMENT_BUS(pipeline_.get()); }

void Pipeline::EndEarly() {
  if (end_early_.exchange(true)) gst_element_send_event(pipeline_.get(), gst_event_new_eos());
}

int Pipeline::frames_to_come() const {
  const auto frames = static_cast<int>(std::lround(1e-9 * length_ns_ * frame_rate_hz_));
  const auto most = static_cast<int>(most_frames_);
  return frames > 0 && most > 0 ? std::min(frames, most) : std::max(frames, most);
}

int Pipeline::Subscribers(const std::string& partition) const {
  int subscribers = 0;
  g_signal_emit_by_name(publish_, "subscribers-in", partition.c_str(), &subscribers);
  return subscribers;
}

std::uint64_t Pipeline::Published(const char* property) const {
  std::uint64_t value = 0;
  g_object_get(publish_, property, &value, nullptr);
  return value;
}

void Pipeline::OnPad(GstPad* pad) {
  GstCaps* caps = gst_pad_query_caps(pad, nullptr);
  const bool video =
      g_str_has_prefix(gst_structure_get_name(gst_caps_get_structure(caps, 0)), "video/");
  gst_caps_unref(caps);
  const ObjectPtr<GstPad> head = StaticPad(head_, "sink");
  if (video && !gst_pad_is_linked(head.get())) {
    gst_pad_link(pad, head.get());
    return;
  }
  // Other streams are only followed to know how long the source is.
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad* at, GstPadProbeInfo* info, gpointer self) {
        static_cast<Pipeline*>(self)->SeeTime(at, GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      this, nullptr);
  GstElement* sink = gst_element_factory_make("fakesink", nullptr);
  g_object_set(sink, "sync", FALSE, "async", FALSE, nullptr);
  gst_bin_add(GST_BIN(pipeline_.get()), sink);
  gst_element_sync_state_with_parent(sink);
  gst_pad_link(pad, StaticPad(sink, "sink").get());
}

// The decoder hands on each picture before it is given the next one. One that is broken it passes
// over in silence.
void Pipeline::OnPicture() {
  if (pictures_read_ > frames_in_ && !end_early_) {
    char* path = g_strdup_printf(pattern_.c_str(), static_cast<int>(frames_in_) + 1);
    GST_ELEMENT_ERROR(pipeline_.get(), STREAM, DECODE,
                      ("%s: the frame is missing or no picture", path), (nullptr));
    g_free(path);
  }
  ++pictures_read_;
}

GstPadProbeReturn Pipeline::OnFrameIn(GstPad* pad, GstPadProbeInfo* info) {
  if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) == 0) {
    // The pictures end with the first one that is not there.
    const bool ends = GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS;
    if (ends && frames_in_ < pictures_) {
      pictures_read_ = pictures_;
      OnPicture();
    }
    return GST_PAD_PROBE_OK;
  }
  if (end_early_ || (most_frames_ > 0 && frames_in_ == most_frames_)) {
    end_early_ = true;
    // The pad takes no more frames after this; the source sees it and stops.
    gst_pad_send_event(pad, gst_event_new_eos());
    return GST_PAD_PROBE_DROP;
  }
  if (frames_in_++ == 0) OnFirstFrame(pad);
  SeeTime(pad, GST_PAD_PROBE_INFO_BUFFER(info));
  return GST_PAD_PROBE_OK;
}

void Pipeline::OnFirstFrame(GstPad* pad) {
  first_frame_ = std::chrono::steady_clock::now();
  gint64 length = 0;
  if (length_ns_ == 0 && gst_pad_peer_query_duration(pad, GST_FORMAT_TIME, &length)) {
    length_ns_ = length;
  }
  GstCaps* caps = gst_pad_get_current_caps(pad);
  int numerator = 0;
  int denominator = 1;
  gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &numerator,
                             &denominator);
  gst_caps_unref(caps);
  frame_rate_hz_ = static_cast<double>(numerator) / denominator;
}

GstPadProbeReturn Pipeline::OnFrameOut(GstBuffer* buffer) {
  try {
    if (leave_) leave_(buffer);
  } catch (const std::exception& error) {
    GST_ELEMENT_ERROR(pipeline_.get(), STREAM, FAILED, ("%s", error.what()), (nullptr));
    return GST_PAD_PROBE_DROP;
  }
  ++frames_out_;
  return GST_PAD_PROBE_OK;
}

// Stream time: what players show, from 0 to the length.
void Pipeline::SeeTime(GstPad* pad, const GstBuffer* buffer) {
  if (!GST_BUFFER_PTS_IS_VALID(buffer)) return;
  GstEvent* event = gst_pad_get_sticky_event(pad, GST_EVENT_SEGMENT, 0);
  if (event == nullptr) return;
  const GstSegment* segment = nullptr;
  gst_event_parse_segment(event, &segment);
  GstClockTime end = GST_BUFFER_PTS(buffer);
  if (GST_BUFFER_DURATION_IS_VALID(buffer)) end += GST_BUFFER_DURATION(buffer);
  const guint64 time = segment->format == GST_FORMAT_TIME
                           ? gst_segment_to_stream_time(segment, GST_FORMAT_TIME, end)
                           : GST_CLOCK_TIME_NONE;
  gst_event_unref(event);
  if (time == GST_CLOCK_TIME_NONE) return;
  auto reached = reached_ns_.load();
  while (static_cast<std::int64_t>(time) > reached &&
         !reached_ns_.compare_exchange_weak(reached, static_cast<std::int64_t>(time))) {
  }
}

// An MP4 file has one picture size, and its encoder wants even sides.
void Pipeline::OnVideoCaps(const GstCaps* caps) {
  int width = 0;
  int height = 0;
  const GstStructure* structure = gst_caps_get_structure(caps, 0);
  gst_structure_get_int(structure, "width", &width);
  gst_structure_get_int(structure, "height", &height);
  if (video_width_ == 0) {
    video_width_ = width;
    video_height_ = height;
    g_object_set(crop_, "right", width % 2, "bottom", height % 2, nullptr);
  } else if (width != video_width_ || height != video_height_) {
    GST_ELEMENT_ERROR(
        pipeline_.get(), STREAM, FORMAT,
        ("Frame %d is of %dx%d px, the first one of %dx%d, which an MP4 file cannot "
         "hold; without the video such a source can be run",
         static_cast<int>(frames_out_) + 1, width, height, video_width_, video_height_),
        (nullptr));
  }
}

}  // namespace windhover
