// SPDX-License-Identifier: Apache-2.0
#include "tests/gst-plugins/harness.h"

#include <gtest/gtest.h>

#include <utility>

namespace windhover {
namespace {

class GstEnvironment : public testing::Environment {
 public:
  void SetUp() override { gst_init(nullptr, nullptr); }
};

[[maybe_unused]] testing::Environment* const kEnvironment =
    testing::AddGlobalTestEnvironment(new GstEnvironment);

}  // namespace

Harness::Harness(const std::string& launch)
    : harness_(gst_harness_new_empty()), bus_(gst_bus_new()) {
  // In a bin of our own, so that there is always a bus.
  GError* error = nullptr;
  GstElement* bin = gst_parse_bin_from_description(launch.c_str(), TRUE, &error);
  if (error != nullptr) {
    ADD_FAILURE() << error->message;
    g_clear_error(&error);
  }
  gst_element_set_bus(bin, bus_);
  static GstStaticPadTemplate source =
      GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS_ANY);
  static GstStaticPadTemplate sink =
      GST_STATIC_PAD_TEMPLATE("sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS_ANY);
  gst_harness_add_element_full(harness_, bin, &source, "sink", &sink, "src");
  gst_pad_add_probe(
      harness_->sinkpad,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_BOTH |
                                   GST_PAD_PROBE_TYPE_EVENT_FLUSH),
      Record, this, nullptr);
  gst_object_unref(bin);
  gst_harness_play(harness_);
}

Harness::~Harness() {
  gst_harness_teardown(harness_);
  gst_object_unref(bus_);
}

GstPadProbeReturn Harness::Record(GstPad*, GstPadProbeInfo* info, gpointer self) {
  auto& log = static_cast<Harness*>(self)->log_;
  if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) != 0) {
    log.push_back("b" + std::to_string(GST_BUFFER_OFFSET(GST_PAD_PROBE_INFO_BUFFER(info))));
  } else if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_EVENT_UPSTREAM) == 0) {
    log.emplace_back(GST_EVENT_TYPE_NAME(GST_PAD_PROBE_INFO_EVENT(info)));
  }
  return GST_PAD_PROBE_OK;
}

void Harness::SetCaps(const std::string& caps) {
  gst_harness_set_src_caps_str(harness_, caps.c_str());
}

GstFlowReturn Harness::Push(BufferPtr buffer) {
  return gst_harness_push(harness_, buffer.release());
}

bool Harness::PushEvent(GstEvent* event) {
  return gst_harness_push_event(harness_, event) != FALSE;
}

void Harness::Flush() {
  PushEvent(gst_event_new_flush_start());
  PushEvent(gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  PushEvent(gst_event_new_segment(&segment));
}

BufferPtr Harness::Pull() { return BufferPtr(gst_harness_try_pull(harness_)); }

std::vector<BufferPtr> Harness::PullAll() {
  std::vector<BufferPtr> all;
  while (BufferPtr buffer = Pull()) all.push_back(std::move(buffer));
  return all;
}

GstClockTime Harness::Latency() { return gst_harness_query_latency(harness_); }

GstElement* Harness::Find(const std::string& name) {
  return gst_bin_get_by_name(GST_BIN(harness_->element), name.c_str());
}

void StopAndUnref::operator()(GstElement* element) const {
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
}

ElementPtr MakeElement(const std::string& name) {
  GstElement* element = gst_element_factory_make(name.c_str(), nullptr);
  if (element == nullptr) ADD_FAILURE() << "no element " << name;
  gst_object_ref_sink(element);
  return ElementPtr(element);
}

ElementPtr MakePipeline(const std::string& launch) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(launch.c_str(), &error);
  if (error != nullptr) {
    ADD_FAILURE() << error->message;
    g_clear_error(&error);
  }
  gst_object_ref_sink(pipeline);
  return ElementPtr(pipeline);
}

void TakeMessages(GstBus* bus, GstMessageType types,
                  const std::function<void(GstMessage*)>& action) {
  while (GstMessage* message = gst_bus_pop_filtered(bus, types)) {
    action(message);
    gst_message_unref(message);
  }
}

std::vector<Harness::Message> Harness::Errors() {
  std::vector<Message> errors;
  TakeMessages(bus_, GST_MESSAGE_ERROR, [&](GstMessage* message) {
    GError* error = nullptr;
    gchar* debug = nullptr;
    gst_message_parse_error(message, &error, &debug);
    errors.push_back({error->message, debug != nullptr ? debug : "", error->domain, error->code});
    g_clear_error(&error);
    g_free(debug);
  });
  return errors;
}

std::vector<GstStructure*> Harness::ElementMessages(const std::string& name) {
  std::vector<GstStructure*> found;
  TakeMessages(bus_, GST_MESSAGE_ELEMENT, [&](GstMessage* message) {
    const GstStructure* structure = gst_message_get_structure(message);
    if (name == gst_structure_get_name(structure)) found.push_back(gst_structure_copy(structure));
  });
  return found;
}

int Harness::CountMessages(GstMessageType type) {
  int count = 0;
  TakeMessages(bus_, type, [&](GstMessage*) { ++count; });
  return count;
}

}  // namespace windhover
