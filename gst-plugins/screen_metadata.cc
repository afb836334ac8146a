// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/screen_metadata.h"

#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "service/gstreamer/homography_meta.h"
#include "service/gstreamer/registration_transform.h"
#include "service/vision/homography.h"

namespace windhover {
namespace {

struct Edges {
  double left, top, right, bottom;

  bool empty() const { return right <= left || bottom <= top; }
};

struct Screen {
  const Eigen::Matrix3d& screen_from_frame;
  double width, height;

  // Boxes cover x <= px < x + width of pixels whose centres lie at integers.
  Edges BoxOf(const Edges& in_frame) const {
    Edges box = {width, height, 0.0, 0.0};
    for (const double x : {in_frame.left, in_frame.right}) {
      for (const double y : {in_frame.top, in_frame.bottom}) {
        const Eigen::Vector2d at =
            Project(screen_from_frame, Eigen::Vector2d(x - 0.5, y - 0.5)).array() + 0.5;
        box.left = std::min(box.left, at.x());
        box.top = std::min(box.top, at.y());
        box.right = std::max(box.right, at.x());
        box.bottom = std::max(box.bottom, at.y());
      }
    }
    return {std::clamp(box.left, 0.0, width), std::clamp(box.top, 0.0, height),
            std::clamp(box.right, 0.0, width), std::clamp(box.bottom, 0.0, height)};
  }
};

bool GetEdges(const GstStructure* structure, Edges& shares) {
  return gst_structure_get(structure, "x_min", G_TYPE_DOUBLE, &shares.left, "y_min", G_TYPE_DOUBLE,
                           &shares.top, "x_max", G_TYPE_DOUBLE, &shares.right, "y_max",
                           G_TYPE_DOUBLE, &shares.bottom, nullptr) != FALSE;
}

void MoveBox(const Screen& screen, GstStructure* structure) {
  Edges e;
  if (!GetEdges(structure, e)) return;
  e = screen.BoxOf({e.left * screen.width, e.top * screen.height, e.right * screen.width,
                    e.bottom * screen.height});
  gst_structure_set(structure, "x_min", G_TYPE_DOUBLE, e.left / screen.width, "y_min",
                    G_TYPE_DOUBLE, e.top / screen.height, "x_max", G_TYPE_DOUBLE,
                    e.right / screen.width, "y_max", G_TYPE_DOUBLE, e.bottom / screen.height,
                    nullptr);
}

void MoveVelocity(const Screen& screen, const Eigen::Vector2d& centre, GstStructure* structure) {
  double x = 0.0;
  double y = 0.0;
  if (!gst_structure_get(structure, "velocity_x", G_TYPE_DOUBLE, &x, "velocity_y", G_TYPE_DOUBLE,
                         &y, nullptr)) {
    return;
  }
  const Eigen::Vector2d half(0.5 * x * screen.width, 0.5 * y * screen.height);
  const Eigen::Vector2d moved = Project(screen.screen_from_frame, centre + half) -
                                Project(screen.screen_from_frame, centre - half);
  gst_structure_set(structure, "velocity_x", G_TYPE_DOUBLE, moved.x() / screen.width, "velocity_y",
                    G_TYPE_DOUBLE, moved.y() / screen.height, nullptr);
}

void CarryRegion(const GstVideoRegionOfInterestMeta& region, const Screen& screen, GstBuffer* to) {
  const Edges in_frame = {static_cast<double>(region.x), static_cast<double>(region.y),
                          static_cast<double>(region.x) + region.w,
                          static_cast<double>(region.y) + region.h};
  const Edges box = screen.BoxOf(in_frame);
  if (box.empty()) return;
  const auto x = static_cast<guint>(std::floor(box.left));
  const auto y = static_cast<guint>(std::floor(box.top));
  GstVideoRegionOfInterestMeta* carried = gst_buffer_add_video_region_of_interest_meta_id(
      to, region.roi_type, x, y, static_cast<guint>(std::ceil(box.right)) - x,
      static_cast<guint>(std::ceil(box.bottom)) - y);
  carried->id = region.id;
  carried->parent_id = region.parent_id;
  const Eigen::Vector2d centre(0.5 * (in_frame.left + in_frame.right - 1.0),
                               0.5 * (in_frame.top + in_frame.bottom - 1.0));
  for (const GList* param = region.params; param != nullptr; param = param->next) {
    GstStructure* structure = gst_structure_copy(static_cast<const GstStructure*>(param->data));
    MoveBox(screen, structure);
    MoveVelocity(screen, centre, structure);
    gst_video_region_of_interest_meta_add_param(carried, structure);
  }
}

bool FitsAnyPicture(const GstMeta& meta) {
  static const std::array<GQuark, 3> bound = {
      g_quark_from_static_string(GST_META_TAG_VIDEO_SIZE_STR),
      g_quark_from_static_string(GST_META_TAG_VIDEO_ORIENTATION_STR),
      g_quark_from_static_string(GST_META_TAG_MEMORY_STR)};
  return std::none_of(bound.begin(), bound.end(), [&](GQuark tag) {
    return gst_meta_api_type_has_tag(meta.info->api, tag) != FALSE;
  });
}

}  // namespace

void CarryMetadata(GstBuffer* from, const ScreenPose& pose, int width, int height, GstBuffer* to) {
  const Screen screen = {pose.screen_from_frame, static_cast<double>(width),
                         static_cast<double>(height)};
  gpointer state = nullptr;
  while (GstMeta* meta = gst_buffer_iterate_meta(from, &state)) {
    const GType api = meta->info->api;
    if (api == gst_windhover_homography_meta_api_get_type()) {
      const auto& old = *reinterpret_cast<GstWindhoverHomographyMeta*>(meta);
      gst_buffer_add_windhover_homography_meta(
          to, RegistrationOnScreen(old.registration, pose, width, height), width, height);
    } else if (api == GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE) {
      CarryRegion(*reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta), screen, to);
    } else if (meta->info->transform_func != nullptr && FitsAnyPicture(*meta)) {
      GstMetaTransformCopy copy = {FALSE, 0, static_cast<gsize>(-1)};
      meta->info->transform_func(to, meta, from, _gst_meta_transform_copy, &copy);
    }
  }
}

}  // namespace windhover
