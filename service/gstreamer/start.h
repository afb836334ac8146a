// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace windhover {

// gst_init with the elements of ours known: those that lie beside the program's own folder, before
// any others of that name that are installed, unless GST_PLUGIN_PATH says where they are. The first
// call sets GST_PLUGIN_PATH: make it before there are threads. Throws std::runtime_error where they
// are not found.
void StartGStreamer();
// The file that the elements come from, once GStreamer is started.
std::string PluginFile();

}  // namespace windhover
