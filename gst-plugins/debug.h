// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

namespace windhover {

// The category "windhover" of GST_DEBUG: all of the plugin logs to it. Made on first use.
GstDebugCategory* DebugCategory();

}  // namespace windhover

#define GST_CAT_DEFAULT (::windhover::DebugCategory())
