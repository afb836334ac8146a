// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/start.h"

#include <gst/gst.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "service/gstreamer/objects.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

// The folder of the plugin that was built or installed with this program; empty where there is
// none.
fs::path PluginFolder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  for (const char* lib : {"lib", WINDHOVER_INSTALL_LIBDIR}) {
    const fs::path folder = program.parent_path().parent_path() / lib / "gstreamer-1.0";
    if (fs::exists(folder / "libgstwindhover.so", error)) return folder;
  }
  return {};
}

ObjectPtr<GstElementFactory> FindElements() {
  return ObjectPtr<GstElementFactory>(gst_element_factory_find("whregister"));
}

}  // namespace

void StartGStreamer() {
  const fs::path folder = PluginFolder();
  const bool told =
      std::getenv("GST_PLUGIN_PATH") != nullptr || std::getenv("GST_PLUGIN_PATH_1_0") != nullptr;
  // GStreamer keeps the first file of a name that it meets, and this path comes before its own.
  if (!told && !folder.empty()) ::setenv("GST_PLUGIN_PATH", folder.c_str(), 1);
  gst_init(nullptr, nullptr);
  if (!FindElements() && !folder.empty()) {
    gst_registry_scan_path(gst_registry_get(), folder.c_str());
  }
  if (!FindElements()) {
    throw std::runtime_error(
        "GStreamer does not find the elements of Windhover: set GST_PLUGIN_PATH to the folder of "
        "libgstwindhover.so");
  }
}

std::string PluginFile() {
  const ObjectPtr<GstPlugin> plugin(
      gst_plugin_feature_get_plugin(GST_PLUGIN_FEATURE(FindElements().get())));
  return gst_plugin_get_filename(plugin.get());
}

}  // namespace windhover
