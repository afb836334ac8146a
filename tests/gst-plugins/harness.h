// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/check/gstharness.h>
#include <gst/gst.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gst-plugins/element.h"

namespace windhover {

// Elements between a test's source and sink pad (GstHarness), their messages, and what came out.
class Harness {
 public:
  // `launch` is a line as of gst-launch-1.0, without source and sink.
  explicit Harness(const std::string& launch);
  ~Harness();
  Harness(const Harness&) = delete;
  Harness& operator=(const Harness&) = delete;

  void SetCaps(const std::string& caps);
  GstFlowReturn Push(BufferPtr buffer);
  bool PushEvent(GstEvent* event);
  // FLUSH_START, FLUSH_STOP and the segment again.
  void Flush();

  // The next buffer that came out, null where there is none yet. Nothing waits.
  BufferPtr Pull();
  std::vector<BufferPtr> PullAll();

  // What came out, in order: "b<offset>" for buffers, names for events ("caps", "gap", ...).
  const std::vector<std::string>& log() const { return log_; }
  void ReserveLog(std::size_t entries) { log_.reserve(entries); }

  GstClockTime Latency();
  GstElement* Find(const std::string& name);
  GstHarness* get() { return harness_; }

  struct Message {
    std::string text;
    std::string debug;
    GQuark domain = 0;
    int code = 0;
  };
  // All error messages up to now.
  std::vector<Message> Errors();
  // All element messages of this name up to now; the caller frees them.
  std::vector<GstStructure*> ElementMessages(const std::string& name);
  int CountMessages(GstMessageType type);

 private:
  static GstPadProbeReturn Record(GstPad* pad, GstPadProbeInfo* info, gpointer self);

  GstHarness* harness_;
  GstBus* bus_;
  std::vector<std::string> log_;
};

struct StopAndUnref {
  void operator()(GstElement* element) const;
};
// An element or pipeline; goes to NULL at its end.
using ElementPtr = std::unique_ptr<GstElement, StopAndUnref>;
ElementPtr MakeElement(const std::string& name);
// `launch` is a line as of gst-launch-1.0.
ElementPtr MakePipeline(const std::string& launch);

// Runs the action with each message taken off the bus now.
void TakeMessages(GstBus* bus, GstMessageType types,
                  const std::function<void(GstMessage*)>& action);

}  // namespace windhover
