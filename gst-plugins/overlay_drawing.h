// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gst-plugins/canvas.h"
#include "gst-plugins/trails.h"
#include "service/options/overlay_options.h"
#include "service/vision/types.h"

namespace windhover {

// Draws, for people, what is known of a frame: boxes, track numbers and trails in a colour of each
// track, and a line about the registration at the lower border. A frame whose registration is lost
// gets a red frame. Sizes follow the height of the picture.
class OverlayDrawing {
 public:
  explicit OverlayDrawing(const OverlayOptions& options)
      : options_(options), trails_(options.trail_frames) {}

  // Frames must come in order. `registration` may be null where it is not known.
  void Draw(const FrameRegistration* registration, const std::vector<Detection>& detections,
            Canvas& canvas);
  // The next frame has nothing to do with the last one.
  void Reset() { trails_.Reset(); }

 private:
  void DrawTrails(Canvas& canvas);
  void DrawDetection(const Detection& detection, Canvas& canvas) const;
  void DrawStatus(const FrameRegistration& registration, int detections, Canvas& canvas) const;

  OverlayOptions options_;
  Trails trails_;
  std::vector<Eigen::Vector2d> path_;
};

}  // namespace windhover
