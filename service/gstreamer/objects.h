// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <memory>
#include <string>

namespace windhover {

struct ObjectUnref {
  void operator()(gpointer object) const { gst_object_unref(object); }
};
// Holds one reference to an element, a pad, a bus, a factory.
template <typename T>
using ObjectPtr = std::unique_ptr<T, ObjectUnref>;

// Sets a property from the text that gst-launch takes for it. Does nothing where the object has no
// property of that name.
void SetProperty(GObject* object, const std::string& name, const std::string& value);

}  // namespace windhover
