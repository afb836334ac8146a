// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/detection_meta.h"

#include <gst/video/video.h>

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

void AddDetection(GstBuffer* buffer, const Detection& detection, double width, double height) {
  const Box& box = detection.box;
  const double left = std::clamp(box.x, 0.0, width);
  const double top = std::clamp(box.y, 0.0, height);
  const double right = std::clamp(box.x + box.width, left, width);
  const double bottom = std::clamp(box.y + box.height, top, height);
  const auto x = static_cast<guint>(std::floor(left));
  const auto y = static_cast<guint>(std::floor(top));
  GstVideoRegionOfInterestMeta* region = gst_buffer_add_video_region_of_interest_meta(
      buffer, kDetectionType, x, y, static_cast<guint>(std::ceil(right)) - x,
      static_cast<guint>(std::ceil(bottom)) - y);
  const auto id = static_cast<gint>(detection.track_id & G_MAXINT);
  region->id = id;
  gst_video_region_of_interest_meta_add_param(
      region,
      gst_structure_new("detection", "x_min", G_TYPE_DOUBLE, left / width, "y_min", G_TYPE_DOUBLE,
                        top / height, "x_max", G_TYPE_DOUBLE, right / width, "y_max", G_TYPE_DOUBLE,
                        bottom / height, "confidence", G_TYPE_DOUBLE, detection.score, "label",
                        G_TYPE_STRING, kDetectionType, "label_id", G_TYPE_INT, 0, nullptr));
  gst_video_region_of_interest_meta_add_param(
      region, gst_structure_new("object_id", "id", G_TYPE_INT, id, nullptr));
  gst_video_region_of_interest_meta_add_param(
      region,
      gst_structure_new("motion", "velocity_x", G_TYPE_DOUBLE, detection.velocity_px.x() / width,
                        "velocity_y", G_TYPE_DOUBLE, detection.velocity_px.y() / height,
                        "age_frames", G_TYPE_INT, detection.age_frames, "track_id", G_TYPE_UINT64,
                        static_cast<guint64>(detection.track_id), nullptr));
}

bool ReadDetection(GstVideoRegionOfInterestMeta* region, double width, double height,
                   Detection& detection) {
  const GstStructure* box = gst_video_region_of_interest_meta_get_param(region, "detection");
  const GstStructure* motion = gst_video_region_of_interest_meta_get_param(region, "motion");
  if (box == nullptr || motion == nullptr) return false;
  double x_min, y_min, x_max, y_max, velocity_x, velocity_y;
  guint64 track_id;
  if (!gst_structure_get(box, "x_min", G_TYPE_DOUBLE, &x_min, "y_min", G_TYPE_DOUBLE, &y_min,
                         "x_max", G_TYPE_DOUBLE, &x_max, "y_max", G_TYPE_DOUBLE, &y_max,
                         "confidence", G_TYPE_DOUBLE, &detection.score, nullptr) ||
      !gst_structure_get(motion, "velocity_x", G_TYPE_DOUBLE, &velocity_x, "velocity_y",
                         G_TYPE_DOUBLE, &velocity_y, "age_frames", G_TYPE_INT,
                         &detection.age_frames, "track_id", G_TYPE_UINT64, &track_id, nullptr)) {
    return false;
  }
  detection.track_id = track_id;
  detection.box = {x_min * width, y_min * height, (x_max - x_min) * width,
                   (y_max - y_min) * height};
  detection.velocity_px = {velocity_x * width, velocity_y * height};
  return true;
}

}  // namespace

void AddDetections(GstBuffer* buffer, const std::vector<Detection>& detections, int width,
                   int height) {
  for (const Detection& detection : detections) AddDetection(buffer, detection, width, height);
}

void GetDetections(GstBuffer* buffer, int width, int height, std::vector<Detection>& detections) {
  static const GQuark type = g_quark_from_static_string(kDetectionType);
  detections.clear();
  gpointer state = nullptr;
  while (GstMeta* meta = gst_buffer_iterate_meta_filtered(
             buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* region = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    Detection detection;
    if (region->roi_type == type && ReadDetection(region, width, height, detection)) {
      detections.push_back(detection);
    }
  }
}

}  // namespace windhover
