// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "service/gstreamer/objects.h"
#include "service/gstreamer/source.h"
#include "service/gstreamer/source_reach.h"

namespace windhover {

// A source, elements of ours and, where there is a path for it, an H.264 file of what comes out of
// them. Frames are counted on the way. Its messages go to the bus.
class Pipeline {
 public:
  // `elements` are made and linked in this order. `video_path` empty: no video. `leave` is called
  // with each buffer that comes out of the last one, on its streaming thread; what it throws
  // becomes an error on the bus. Throws std::runtime_error where an element is not installed.
  Pipeline(const Source& source, const std::vector<std::string>& elements,
           const std::string& video_path, std::function<void(GstBuffer*)> leave = nullptr);
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;
  ~Pipeline();

  // Sets the option on each element of ours that has it. It must have been checked.
  void Set(const std::string& name, const std::string& value);
  void SetState(GstState state);
  GstBus* bus() const;

  // Not more than so many frames are to enter. Before it plays; 0: all.
  void EndAfter(int frames) { most_frames_ = frames; }
  // No frame enters any more; what is on the way comes out, then the stream ends. The second call
  // also ends a source that stands still.
  void EndEarly();

  // Any thread.
  std::uint64_t frames_in() const { return frames_in_; }
  std::uint64_t frames_out() const { return frames_out_; }
  // In all, as far as the source's length and rate say; 0 where they do not.
  int frames_to_come() const;
  // When the first frame came in; the epoch of the clock before that.
  std::chrono::steady_clock::time_point first_frame() const { return first_frame_; }
  // Of all the source's streams.
  SourceReach reach() const { return {frames_in_, reached_ns_, length_ns_, missing_bytes_}; }

  // Of whpublish, which must be among the elements: subscribers in a partition, and a counter by
  // its property's name. Any thread.
  int Subscribers(const std::string& partition) const;
  std::uint64_t Published(const char* property) const;

 private:
  void AddSource(const Source& source);
  void AddPictures(const Source& source);
  void AddVideo(const std::string& path);
  GstElement* Add(const std::string& factory);
  GstElement* Append(const std::string& factory);
  // These are called by streaming threads.
  void OnPad(GstPad* pad);
  void OnPicture();
  GstPadProbeReturn OnFrameIn(GstPad* pad, GstPadProbeInfo* info);
  void OnFirstFrame(GstPad* pad);
  GstPadProbeReturn OnFrameOut(GstBuffer* buffer);
  void OnVideoCaps(const GstCaps* caps);
  void SeeTime(GstPad* pad, const GstBuffer* buffer);

  ObjectPtr<GstElement> pipeline_;
  GstElement* head_ = nullptr;     // takes the frames
  GstElement* last_ = nullptr;     // what Append links to
  GstElement* crop_ = nullptr;     // makes the sides even for the encoder
  GstElement* publish_ = nullptr;  // whpublish
  std::vector<GstElement*> ours_;
  std::function<void(GstBuffer*)> leave_;
  std::string pattern_;  // of the pictures' paths; empty for other sources
  std::uint64_t pictures_ = 0;
  std::uint64_t pictures_read_ = 0;
  std::uint64_t most_frames_ = 0;
  std::int64_t missing_bytes_ = 0;
  std::atomic<std::uint64_t> frames_in_ = 0;
  std::atomic<std::uint64_t> frames_out_ = 0;
  std::atomic<double> frame_rate_hz_ = 0.0;
  std::atomic<std::chrono::steady_clock::time_point> first_frame_{};
  std::atomic<std::int64_t> reached_ns_ = 0;
  std::atomic<std::int64_t> length_ns_ = 0;
  std::atomic<bool> end_early_ = false;
  int video_width_ = 0;  // 0 before the first caps
  int video_height_ = 0;
};

}  // namespace windhover
