// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <vector>

#include "service/vision/types.h"

namespace windhover {

// Detections as GstVideoRegionOfInterestMeta of the type "moving-object", the metadata that other
// elements read. The region is the box clipped to the frame and rounded outwards; `id` is the
// track. Each has three structures as params:
//   "detection"  x_min, y_min, x_max, y_max (double, share of the frame's width and height),
//                confidence (double, 0 to 1), label (string "moving-object"), label_id (int 0):
//                as DL Streamer writes them
//   "object_id"  id (int): the track, as DL Streamer writes it
//   "motion"     velocity_x, velocity_y (double, share of the frame's width and height in one
//   frame,
//                over the ground), age_frames (int), track_id (uint64)
// Shares rather than pixels keep the structures right behind a scaler.
inline constexpr char kDetectionType[] = "moving-object";

// `buffer` must be writable; width and height are the frame's, px.
void AddDetections(GstBuffer* buffer, const std::vector<Detection>& detections, int width,
                   int height);

// The detections that AddDetections has put on the buffer, told for a frame of this size, in
// `detections` (emptied first). Regions of other types, or without these structures, are left out.
void GetDetections(GstBuffer* buffer, int width, int height, std::vector<Detection>& detections);

}  // namespace windhover
