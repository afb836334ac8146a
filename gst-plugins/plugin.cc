// SPDX-License-Identifier: Apache-2.0
#include <gst/gst.h>

#include "gst-plugins/background_element.h"
#include "gst-plugins/motion_element.h"
#include "gst-plugins/overlay_element.h"
#include "gst-plugins/publish_element.h"
#include "gst-plugins/register_element.h"
#include "gst-plugins/stabilize_element.h"
#include "service/gstreamer/homography_meta.h"

namespace {

gboolean InitPlugin(GstPlugin* plugin) {
  using namespace windhover;
  gst_windhover_homography_meta_get_info();
  return MakeAvailable<RegisterElement>(plugin) && MakeAvailable<BackgroundElement>(plugin) &&
         MakeAvailable<MotionElement>(plugin) && MakeAvailable<PublishElement>(plugin) &&
         MakeAvailable<OverlayElement>(plugin) && MakeAvailable<StabilizeElement>(plugin);
}

}  // namespace

// The sources are Apache-2.0; linked with FFTW3 the binary falls under the GPL.
GST_PLUGIN_DEFINE(
    GST_VERSION_MAJOR, GST_VERSION_MINOR, windhover,
    "Windhover: holds the ground still under aerial video, finds what moves on it and "
    "publishes both over DDS",
    InitPlugin, WINDHOVER_VERSION, "GPL", "Windhover", "windhover")
