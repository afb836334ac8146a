// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/backend_context.h"

#include <utility>

#include "gst-plugins/debug.h"

namespace windhover {
namespace {

using BoxedBackend = std::shared_ptr<Backend>;

gpointer CopyBoxed(gpointer boxed) { return new BoxedBackend(*static_cast<BoxedBackend*>(boxed)); }
void FreeBoxed(gpointer boxed) { delete static_cast<BoxedBackend*>(boxed); }

// For people who watch the bus.
void DescribeBoxed(const GValue* boxed, GValue* text) {
  const auto* backend = static_cast<const BoxedBackend*>(g_value_get_boxed(boxed));
  const bool exists = backend != nullptr && *backend != nullptr;
  g_value_set_string(text, exists ? (*backend)->device().Describe().c_str() : "none");
}

// Several modules of one process may hold this code: whichever comes first registers the type.
GType BoxedBackendType() {
  static const GType type = [] {
    constexpr char kName[] = "GstWindhoverBackend";
    if (const GType known = g_type_from_name(kName)) return known;
    const GType made = g_boxed_type_register_static(kName, CopyBoxed, FreeBoxed);
    g_value_register_transform_func(made, G_TYPE_STRING, DescribeBoxed);
    return made;
  }();
  return type;
}

void WarnOf(GstElement* element, const std::string& text) {
  GST_ELEMENT_WARNING(element, RESOURCE, NOT_FOUND, ("%s", text.c_str()), (nullptr));
}

}  // namespace

GstContext* MakeBackendContext(const std::shared_ptr<Backend>& backend, const std::string& device) {
  GstContext* context = gst_context_new(kBackendContextType, TRUE);
  gst_structure_set(gst_context_writable_structure(context), "backend", BoxedBackendType(),
                    &backend, "device", G_TYPE_STRING, device.c_str(), "description", G_TYPE_STRING,
                    backend->device().Describe().c_str(), nullptr);
  return context;
}

std::shared_ptr<Backend> BackendOfContext(GstContext* context) {
  if (!gst_context_has_context_type(context, kBackendContextType)) return nullptr;
  const GValue* value = gst_structure_get_value(gst_context_get_structure(context), "backend");
  if (value == nullptr || !G_VALUE_HOLDS(value, BoxedBackendType())) return nullptr;
  const auto* boxed = static_cast<const BoxedBackend*>(g_value_get_boxed(value));
  return boxed != nullptr ? *boxed : nullptr;
}

std::shared_ptr<Backend> SharedBackend::Acquire(const std::string& device) {
  if (!Suits(device) && !AskNeighbours(device)) {
    gst_element_post_message(
        element_, gst_message_new_need_context(GST_OBJECT(element_), kBackendContextType));
  }
  if (Suits(device)) {
    const std::scoped_lock lock(mutex_);
    return BackendOfContext(context_);
  }

  std::shared_ptr<Backend> backend =
      Backend::Create(device, [this](const std::string& text) { WarnOf(element_, text); });
  GST_INFO_OBJECT(element_, "made a backend on %s", backend->device().Describe().c_str());
  GstContext* made = MakeBackendContext(backend, device);
  const bool shared_exists = [this] {
    const std::scoped_lock lock(mutex_);
    return context_ != nullptr;
  }();
  if (!shared_exists) {
    // Also sets it here, through SetContext.
    gst_element_set_context(element_, made);
    gst_element_post_message(
        element_, gst_message_new_have_context(GST_OBJECT(element_), gst_context_ref(made)));
  }
  gst_context_unref(made);
  return backend;
}

void SharedBackend::SetContext(GstContext* context) {
  if (context == nullptr || BackendOfContext(context) == nullptr) return;
  const std::scoped_lock lock(mutex_);
  gst_context_replace(&context_, context);
}

bool SharedBackend::Answer(GstQuery* query) {
  const gchar* type = nullptr;
  gst_query_parse_context_type(query, &type);
  if (g_strcmp0(type, kBackendContextType) != 0) return false;
  const std::scoped_lock lock(mutex_);
  if (context_ == nullptr) return false;
  gst_query_set_context(query, context_);
  return true;
}

void SharedBackend::Forget() {
  const std::scoped_lock lock(mutex_);
  gst_context_replace(&context_, nullptr);
}

bool SharedBackend::Suits(const std::string& device) {
  const std::scoped_lock lock(mutex_);
  if (context_ == nullptr) return false;
  if (device.empty()) return true;
  const gchar* made_from = gst_structure_get_string(gst_context_get_structure(context_), "device");
  return device == (made_from != nullptr ? made_from : "") ||
         device == BackendOfContext(context_)->device().selector;
}

bool SharedBackend::AskNeighbours(const std::string& device) {
  GstQuery* query = gst_query_new_context(kBackendContextType);
  for (GList* item = element_->pads; item != nullptr; item = item->next) {
    if (!gst_pad_peer_query(GST_PAD(item->data), query)) continue;
    GstContext* context = nullptr;
    gst_query_parse_context(query, &context);
    if (context != nullptr) gst_element_set_context(element_, context);
    if (Suits(device)) break;
  }
  gst_query_unref(query);
  return Suits(device);
}

}  // namespace windhover
