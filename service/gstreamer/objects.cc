// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/objects.h"

namespace windhover {

void SetProperty(GObject* object, const std::string& name, const std::string& value) {
  const GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(object), name.c_str());
  if (spec == nullptr) return;
  if (spec->value_type == G_TYPE_STRING) {
    // A text as it is: gst-launch would take quotes and escapes out of it.
    g_object_set(object, name.c_str(), value.c_str(), nullptr);
  } else {
    gst_util_set_object_arg(object, name.c_str(), value.c_str());
  }
}

}  // namespace windhover
