// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <optional>

#include "service/vision/types.h"

namespace windhover {

// Decides when people are told that registration was lost or found again: at each change, but not
// more often than once a second of the video's own time. Where frames have no time stamp, only by
// the number of frames, 30 to a second.
class RegistrationReport {
 public:
  struct News {
    bool lost = false;
    // Changes since the last news that were kept back, this one not counted.
    int changes_kept_back = 0;
  };

  // Call for each frame, in order. kDegraded counts as found.
  std::optional<News> Observe(RegistrationQuality quality, GstClockTime pts);
  void Reset();

 private:
  bool told_lost_ = false;
  bool was_lost_ = false;
  int changes_ = 0;
  int frames_since_news_ = 0;
  GstClockTime last_news_ = GST_CLOCK_TIME_NONE;
  bool ever_told_ = false;
};

// The element message "windhover-registration": quality ("valid", "degraded" or "lost"),
// frame-number (uint64), pts (clock time), inliers, tiles (int), residual-px (double) and
// changes-kept-back (int). A lost registration is also logged as a warning.
void PostRegistrationNews(GstElement* element, const RegistrationReport::News& news,
                          const FrameRegistration& registration, GstClockTime pts);

}  // namespace windhover
