// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/app/option_settings.h"
#include "service/app/source.h"
#include "service/gstreamer/objects.h"

namespace windhover {

// The main job's pipeline: source ! whregister ! whbackground ! whmotion ! whpublish ! whoverlay
// and, where there is a path for it, an H.264 file. Frames are counted on the way. Its messages go
// to the bus.
class Pipeline {
 public:
  // Throws std::runtime_error where an element is not installed. `video_path` empty: no video.
  Pipeline(const Source& source, const std::string& video_path);
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;
  ~Pipeline();

  // Sets the option on each element that has it. It must have been checked: see ParseOptionSetting.
  void Set(const OptionSetting& setting);
  void SetState(GstState state);
  GstBus* bus() const;

  // No frame enters any more; what is on the way comes out, then the stream ends. The second call
  // also ends a source that stands still.
  void EndEarly();

  // Any thread.
  std::uint64_t frames_in() const { return frames_in_; }
  std::uint64_t frames_out() const { return frames_out_; }
  // When the first frame came in; the epoch of the clock before that.
  std::chrono::steady_clock::time_point first_frame() const { return first_frame_; }
  // Time of the source up to which frames have come in, of all its streams; and its length, 0 where
  // it is not known.
  std::int64_t reached_ns() const { return reached_ns_; }
  std::int64_t length_ns() const { return length_ns_; }

  // Subscribers of whpublish in a partition, and a counter of it by its property's name. Any
  // thread.
  int Subscribers(const std::string& partition) const;
  std::uint64_t Published(const char* property) const;

 private:
  void AddSource(const Source& source);
  void AddVideo(const std::string& path);
  GstElement* Add(const char* factory);
  GstElement* Append(const char* factory);
  // These are called by streaming threads.
  void OnPad(GstPad* pad);
  GstPadProbeReturn OnFrameIn(GstPad* pad, GstBuffer* buffer);
  void OnVideoCaps(const GstCaps* caps);
  void SeeTime(GstPad* pad, const GstBuffer* buffer);

  ObjectPtr<GstElement> pipeline_;
  GstElement* head_ = nullptr;     // takes the frames
  GstElement* last_ = nullptr;     // what Append links to
  GstElement* crop_ = nullptr;     // makes the sides even for the encoder
  GstElement* publish_ = nullptr;  // whpublish
  std::vector<GstElement*> ours_;
  std::atomic<std::uint64_t> frames_in_ = 0;
  std::atomic<std::uint64_t> frames_out_ = 0;
  std::atomic<std::chrono::steady_clock::time_point> first_frame_{};
  std::atomic<std::int64_t> reached_ns_ = 0;
  std::atomic<std::int64_t> length_ns_ = 0;
  std::atomic<bool> end_early_ = false;
  int video_width_ = 0;  // 0 before the first caps
  int video_height_ = 0;
};

}  // namespace windhover
