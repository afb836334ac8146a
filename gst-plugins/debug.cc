// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/debug.h"

namespace windhover {

GstDebugCategory* DebugCategory() {
  static GstDebugCategory* const category = [] {
    GstDebugCategory* made = nullptr;
    GST_DEBUG_CATEGORY_INIT(made, "windhover", GST_DEBUG_FG_CYAN, "Windhover: aerial video");
    return made;
  }();
  return category;
}

}  // namespace windhover
