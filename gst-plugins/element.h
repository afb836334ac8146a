// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>
#include <gst/video/video.h>

#include <memory>

#include "gst-plugins/luma.h"
#include "gst-plugins/option_properties.h"

namespace windhover {

struct BufferUnref {
  void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
};
using BufferPtr = std::unique_ptr<GstBuffer, BufferUnref>;
// The same buffer where nobody else holds it, else a copy that shares its memory.
BufferPtr MakeWritable(BufferPtr buffer);

// What gst-inspect-1.0 says of an element, and the name it is made by.
struct ElementText {
  const char* name;
  const char* type_name;
  const char* long_name;
  const char* klass;
  const char* description;
};

// What one of our elements does between its sink pad and its source pad, both of the same caps. The
// host (element.cc) talks to GStreamer: pads, caps, events, queries, states, properties. It keeps
// exceptions from crossing into C: they become error messages (error_report.h).
//
// An element has a `static const ElementText kText`, a `static void
// InstallProperties(GObjectClass*)` and a constructor from the GstElement*.
class Element {
 public:
  // Of both pads; an element that takes less has a kCaps of its own.
  static constexpr const char* kCaps = GST_VIDEO_CAPS_MAKE(WINDHOVER_VIDEO_FORMATS);

  explicit Element(GstElement* host) : host_(host) {}
  virtual ~Element() = default;
  Element(const Element&) = delete;
  Element& operator=(const Element&) = delete;

  // State changes, in the application's thread: NULL to READY, READY to PAUSED, back, and back.
  virtual void Open() {}
  virtual void Start() {}
  virtual void Stop() {}
  virtual void Close() {}

  // Called in the streaming thread, one at a time, between Start and Stop.

  // New caps; all frames of the old ones have been processed and drained.
  virtual void Configure(const GstVideoInfo& info) = 0;
  // Takes a frame of those caps; sends it on now or later.
  virtual GstFlowReturn Process(BufferPtr buffer) = 0;
  // A serialised event that needs no other treatment; sends it on behind the frames held.
  virtual bool Forward(GstEvent* event);
  // Sends on all that is held: no frame that belongs to it follows. Drops the rest where downstream
  // does not take it.
  virtual GstFlowReturn Drain() { return GST_FLOW_OK; }
  // What follows has nothing to do with what came before: after Drain at a gap or another segment,
  // without it after a flush, where what is held must be dropped.
  virtual void Reset() {}
  // All frames have been sent on and the stream ends.
  virtual void End() {}

  // Called from any thread.

  // Delay that holding frames adds.
  virtual GstClockTime added_latency() const { return 0; }
  // Buffers that are held at a time.
  virtual guint held_buffers() const { return 0; }
  virtual void SetContext(GstContext*) {}
  virtual bool AnswerContext(GstQuery*) { return false; }
  // With the object's lock held. False where there is no such property.
  virtual bool SetProperty(guint id, const GValue* value) = 0;
  virtual bool GetProperty(guint id, GValue* value) = 0;

  GstElement* host() const { return host_; }

 protected:
  GstFlowReturn Push(BufferPtr buffer);
  bool PushEvent(GstEvent* event);
  GstPad* source_pad() const;

 private:
  GstElement* host_;
};

// An element whose properties are option structs. Changes take effect with the next step from READY
// to PAUSED.
template <typename... Structs>
class ElementWithOptions : public Element {
 public:
  using Element::Element;

  static void InstallProperties(GObjectClass* klass) {
    OptionProperties<Structs...>::Install(klass, GST_PARAM_MUTABLE_READY);
  }
  bool SetProperty(guint id, const GValue* value) override { return properties_.Set(id, value); }
  bool GetProperty(guint id, GValue* value) override { return properties_.Get(id, value); }

 protected:
  static constexpr guint kFirstOwnProperty = OptionProperties<Structs...>::kCount + 1;

  // The options as they are now.
  template <typename S>
  S Options() const {
    GST_OBJECT_LOCK(host());
    S options = properties_.template get<S>();
    GST_OBJECT_UNLOCK(host());
    return options;
  }

 private:
  OptionProperties<Structs...> properties_;
};

// The GObject around an Element.
struct ElementHost {
  GstElement parent;
  GstPad* sink;
  GstPad* source;
  Element* element;
  // Of the streaming thread.
  GstCaps* caps;          // null until caps have been accepted
  GstCaps* refused_caps;  // offered again with each event or frame, but reported once
  GstSegment segment;
};

struct ElementTypeDescription {
  ElementText text;
  const char* caps;
  void (*install_properties)(GObjectClass*);
  Element* (*make)(GstElement*);
};
// `description` must live as long as the process.
GType RegisterElementType(const ElementTypeDescription& description);

// Makes the element available by its name; for plugin_init.
template <typename T>
bool MakeAvailable(GstPlugin* plugin) {
  static const ElementTypeDescription description = {
      T::kText, T::kCaps, T::InstallProperties,
      [](GstElement* host) -> Element* { return new T(host); }};
  return gst_element_register(plugin, T::kText.name, GST_RANK_NONE,
                              RegisterElementType(description)) != FALSE;
}

}  // namespace windhover
