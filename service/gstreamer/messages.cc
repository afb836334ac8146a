// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/messages.h"

#include <memory>

namespace windhover {

std::string TextOf(GstMessage* message) {
  GError* error = nullptr;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
    gst_message_parse_error(message, &error, nullptr);
  } else {
    gst_message_parse_warning(message, &error, nullptr);
  }
  std::string text = error->message;
  if (g_error_matches(error, GST_STREAM_ERROR, GST_STREAM_ERROR_TYPE_NOT_FOUND) ||
      g_error_matches(error, GST_STREAM_ERROR, GST_STREAM_ERROR_WRONG_TYPE)) {
    text = "not a video: " + text;
  }
  g_error_free(error);
  return text;
}

std::optional<std::string> DeviceOf(GstMessage* message) {
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_HAVE_CONTEXT) return std::nullopt;
  GstContext* context = nullptr;
  gst_message_parse_have_context(message, &context);
  std::optional<std::string> device;
  if (gst_context_has_context_type(context, "windhover.backend")) {
    const char* text = gst_structure_get_string(gst_context_get_structure(context), "description");
    if (text != nullptr) device = text;
  }
  gst_context_unref(context);
  return device;
}

std::string AwaitEnd(GstBus* bus, const std::function<void(GstMessage*)>& on_message,
                     const std::function<void()>& tick) {
  constexpr GstClockTime kTick = 100 * GST_MSECOND;
  struct Unref {
    void operator()(GstMessage* message) const { gst_message_unref(message); }
  };
  GstClockTime next_tick = gst_util_get_timestamp() + kTick;
  while (true) {
    const GstClockTime now = gst_util_get_timestamp();
    if (now >= next_tick) {
      if (tick) tick();
      next_tick = now + kTick;
      continue;
    }
    const std::unique_ptr<GstMessage, Unref> message(gst_bus_timed_pop(bus, next_tick - now));
    if (!message) continue;
    if (GST_MESSAGE_TYPE(message.get()) == GST_MESSAGE_EOS) return "";
    if (GST_MESSAGE_TYPE(message.get()) == GST_MESSAGE_ERROR) return TextOf(message.get());
    if (on_message) on_message(message.get());
  }
}

}  // namespace windhover
