// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/element.h"

#include <utility>

#include "gst-plugins/debug.h"
#include "gst-plugins/error_report.h"

namespace windhover {
namespace {

ElementHost* HostOf(gpointer object) { return static_cast<ElementHost*>(object); }

GstElementClass* ParentClass() {
  static auto* const parent = static_cast<GstElementClass*>(g_type_class_ref(GST_TYPE_ELEMENT));
  return parent;
}

// Runs `action`, which returns a value; what it throws becomes an error message and `failed`.
template <typename Value, typename Action>
Value Guarded(ElementHost* host, Value failed, Action&& action, bool starting = false) noexcept {
  try {
    return action();
  } catch (...) {
    PostCurrentException(GST_ELEMENT(host), starting);
    return failed;
  }
}

bool DrainAndReset(ElementHost* host) {
  host->element->Drain();
  host->element->Reset();
  return true;
}

GstFlowReturn Chain(GstPad*, GstObject* parent, GstBuffer* raw) {
  ElementHost* host = HostOf(parent);
  BufferPtr buffer(raw);
  if (host->caps == nullptr) return GST_FLOW_NOT_NEGOTIATED;
  return Guarded(host, GST_FLOW_ERROR, [&] {
    if (GST_BUFFER_IS_DISCONT(buffer.get())) DrainAndReset(host);
    return host->element->Process(std::move(buffer));
  });
}

bool Configure(ElementHost* host, GstCaps* caps) {
  return Guarded(host, false, [&] {
    GstVideoInfo info;
    if (!gst_video_info_from_caps(&info, caps)) return false;
    host->element->Drain();
    gst_caps_replace(&host->caps, nullptr);
    host->element->Configure(info);
    gst_caps_replace(&host->caps, caps);
    return true;
  });
}

gboolean HandleCaps(ElementHost* host, GstEvent* event) {
  GstCaps* caps = nullptr;
  gst_event_parse_caps(event, &caps);
  const auto are = [caps](GstCaps* known) {
    return known != nullptr && gst_caps_is_equal(known, caps);
  };
  const bool accepted = are(host->caps) || (!are(host->refused_caps) && Configure(host, caps));
  gst_caps_replace(&host->refused_caps, accepted ? nullptr : caps);
  if (accepted) return gst_pad_push_event(host->source, event);
  gst_event_unref(event);
  return FALSE;
}

gboolean HandleSegment(ElementHost* host, GstEvent* event) {
  const GstSegment* segment = nullptr;
  gst_event_parse_segment(event, &segment);
  Guarded(host, false, [&] {
    host->element->Drain();
    if (!gst_segment_is_equal(segment, &host->segment)) host->element->Reset();
    return true;
  });
  gst_segment_copy_into(segment, &host->segment);
  return gst_pad_push_event(host->source, event);
}

gboolean SinkEvent(GstPad* pad, GstObject* parent, GstEvent* event) {
  ElementHost* host = HostOf(parent);
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_CAPS:
      return HandleCaps(host, event);
    case GST_EVENT_SEGMENT:
      return HandleSegment(host, event);
    case GST_EVENT_STREAM_START:
    case GST_EVENT_STREAM_GROUP_DONE:
    case GST_EVENT_SEGMENT_DONE:
    case GST_EVENT_GAP:
      Guarded(host, false, [&] { return DrainAndReset(host); });
      return gst_pad_push_event(host->source, event);
    case GST_EVENT_EOS:
      Guarded(host, false, [&] {
        host->element->Drain();
        host->element->End();
        return true;
      });
      return gst_pad_push_event(host->source, event);
    case GST_EVENT_FLUSH_STOP:
      Guarded(host, false, [&] {
        host->element->Reset();
        return true;
      });
      gst_segment_init(&host->segment, GST_FORMAT_UNDEFINED);
      return gst_pad_push_event(host->source, event);
    default:
      if (!GST_EVENT_IS_SERIALIZED(event)) return gst_pad_event_default(pad, parent, event);
      return host->element->Forward(event) ? TRUE : FALSE;
  }
}

// Our own picture is the whole one, and frames that are held must not exhaust the pool of the
// element before us.
void CorrectAllocation(ElementHost* host, GstQuery* query) {
  guint index = 0;
  if (gst_query_find_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, &index)) {
    gst_query_remove_nth_allocation_meta(query, index);
  }
  const guint held = host->element->held_buffers();
  for (guint i = 0; i < gst_query_get_n_allocation_pools(query); ++i) {
    GstBufferPool* pool = nullptr;
    guint size = 0, minimum = 0, maximum = 0;
    gst_query_parse_nth_allocation_pool(query, i, &pool, &size, &minimum, &maximum);
    gst_query_set_nth_allocation_pool(query, i, pool, size, minimum + held,
                                      maximum != 0 ? maximum + held : 0);
    if (pool != nullptr) gst_object_unref(pool);
  }
}

gboolean SinkQuery(GstPad* pad, GstObject* parent, GstQuery* query) {
  ElementHost* host = HostOf(parent);
  switch (GST_QUERY_TYPE(query)) {
    case GST_QUERY_CONTEXT:
      if (host->element->AnswerContext(query)) return TRUE;
      return gst_pad_query_default(pad, parent, query);
    case GST_QUERY_DRAIN:
      Guarded(host, GST_FLOW_ERROR, [&] { return host->element->Drain(); });
      return gst_pad_query_default(pad, parent, query);
    case GST_QUERY_ALLOCATION:
      if (!gst_pad_peer_query(host->source, query)) return FALSE;
      CorrectAllocation(host, query);
      return TRUE;
    default:
      return gst_pad_query_default(pad, parent, query);
  }
}

gboolean SourceQuery(GstPad* pad, GstObject* parent, GstQuery* query) {
  ElementHost* host = HostOf(parent);
  switch (GST_QUERY_TYPE(query)) {
    case GST_QUERY_CONTEXT:
      if (host->element->AnswerContext(query)) return TRUE;
      return gst_pad_query_default(pad, parent, query);
    case GST_QUERY_LATENCY: {
      if (!gst_pad_peer_query(host->sink, query)) return FALSE;
      gboolean live = FALSE;
      GstClockTime minimum = 0, maximum = GST_CLOCK_TIME_NONE;
      gst_query_parse_latency(query, &live, &minimum, &maximum);
      const GstClockTime added = host->element->added_latency();
      if (GST_CLOCK_TIME_IS_VALID(maximum)) maximum += added;
      gst_query_set_latency(query, live, minimum + added, maximum);
      return TRUE;
    }
    default:
      return gst_pad_query_default(pad, parent, query);
  }
}

GstStateChangeReturn ChangeState(GstElement* object, GstStateChange transition) {
  ElementHost* host = HostOf(object);
  Element* element = host->element;
  const bool ready = Guarded(
      host, false,
      [&] {
        if (transition == GST_STATE_CHANGE_NULL_TO_READY) element->Open();
        if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) element->Start();
        return true;
      },
      true);
  if (!ready) return GST_STATE_CHANGE_FAILURE;

  const GstStateChangeReturn result = ParentClass()->change_state(object, transition);
  Guarded(host, false, [&] {
    if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) {
      element->Stop();
      gst_caps_replace(&host->caps, nullptr);
      gst_caps_replace(&host->refused_caps, nullptr);
      gst_segment_init(&host->segment, GST_FORMAT_UNDEFINED);
    }
    if (transition == GST_STATE_CHANGE_READY_TO_NULL) element->Close();
    return true;
  });
  return result;
}

void SetContextOf(GstElement* object, GstContext* context) {
  HostOf(object)->element->SetContext(context);
  ParentClass()->set_context(object, context);
}

void SetPropertyOf(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  GST_OBJECT_LOCK(object);
  const bool known = HostOf(object)->element->SetProperty(id, value);
  GST_OBJECT_UNLOCK(object);
  if (!known) G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
}

void GetPropertyOf(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  GST_OBJECT_LOCK(object);
  const bool known = HostOf(object)->element->GetProperty(id, value);
  GST_OBJECT_UNLOCK(object);
  if (!known) G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
}

void FinalizeHost(GObject* object) {
  ElementHost* host = HostOf(object);
  delete host->element;
  gst_caps_replace(&host->caps, nullptr);
  gst_caps_replace(&host->refused_caps, nullptr);
  G_OBJECT_CLASS(ParentClass())->finalize(object);
}

void InitClass(gpointer klass, gpointer data) {
  const auto& description = *static_cast<const ElementTypeDescription*>(data);
  auto* object_class = static_cast<GObjectClass*>(klass);
  object_class->set_property = SetPropertyOf;
  object_class->get_property = GetPropertyOf;
  object_class->finalize = FinalizeHost;
  description.install_properties(object_class);

  auto* element_class = static_cast<GstElementClass*>(klass);
  element_class->change_state = ChangeState;
  element_class->set_context = SetContextOf;
  const ElementText& text = description.text;
  gst_element_class_set_static_metadata(element_class, text.long_name, text.klass, text.description,
                                        "The Windhover authors");
  GstCaps* caps = gst_caps_from_string(description.caps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS, caps));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_caps_unref(caps);
}

GstPad* AddPad(ElementHost* host, gpointer klass, const char* name) {
  GstPad* pad = gst_pad_new_from_template(
      gst_element_class_get_pad_template(static_cast<GstElementClass*>(klass), name), name);
  GST_PAD_SET_PROXY_CAPS(pad);
  GST_PAD_SET_PROXY_SCHEDULING(pad);
  gst_element_add_pad(GST_ELEMENT(host), pad);
  return pad;
}

GQuark DescriptionKey() { return g_quark_from_static_string("windhover-element-type"); }

void InitHost(GTypeInstance* instance, gpointer klass) {
  const auto* description = static_cast<const ElementTypeDescription*>(
      g_type_get_qdata(G_TYPE_FROM_CLASS(klass), DescriptionKey()));
  ElementHost* host = HostOf(instance);
  gst_segment_init(&host->segment, GST_FORMAT_UNDEFINED);
  host->sink = AddPad(host, klass, "sink");
  gst_pad_set_chain_function(host->sink, Chain);
  gst_pad_set_event_function(host->sink, SinkEvent);
  gst_pad_set_query_function(host->sink, SinkQuery);
  host->source = AddPad(host, klass, "src");
  gst_pad_set_query_function(host->source, SourceQuery);
  host->element = description->make(GST_ELEMENT(host));
}

}  // namespace

BufferPtr MakeWritable(BufferPtr buffer) {
  return BufferPtr(gst_buffer_make_writable(buffer.release()));
}

bool Element::Forward(GstEvent* event) { return PushEvent(event); }

GstFlowReturn Element::Push(BufferPtr buffer) {
  return gst_pad_push(source_pad(), buffer.release());
}

bool Element::PushEvent(GstEvent* event) {
  return gst_pad_push_event(source_pad(), event) != FALSE;
}

GstPad* Element::source_pad() const { return HostOf(host_)->source; }

GType RegisterElementType(const ElementTypeDescription& description) {
  const GTypeInfo info = {
      sizeof(GstElementClass), nullptr, nullptr,  InitClass, nullptr, &description,
      sizeof(ElementHost),     0,       InitHost, nullptr};
  const GType type =
      g_type_register_static(GST_TYPE_ELEMENT, description.text.type_name, &info, GTypeFlags{});
  g_type_set_qdata(type, DescriptionKey(), const_cast<ElementTypeDescription*>(&description));
  return type;
}

}  // namespace windhover
