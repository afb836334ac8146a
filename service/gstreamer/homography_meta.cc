// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/homography_meta.h"

#include <gst/video/video.h>

#include "service/gstreamer/meta_registration.h"
#include "service/gstreamer/registration_transform.h"

namespace {

using windhover::FrameRegistration;

// new_from_old of a scaler's work. Where the old buffer carried a GstVideoCropMeta, the caps that
// the scaler speaks of are those of the cropped part, and the homographies those of the whole
// picture.
Eigen::Matrix3d PictureTransform(GstBuffer* from, const GstVideoMetaTransform& scale) {
  Eigen::Matrix3d new_from_old = windhover::ScaleOfPicture(
      GST_VIDEO_INFO_WIDTH(scale.in_info), GST_VIDEO_INFO_HEIGHT(scale.in_info),
      GST_VIDEO_INFO_WIDTH(scale.out_info), GST_VIDEO_INFO_HEIGHT(scale.out_info));
  const GstVideoCropMeta* crop = gst_buffer_get_video_crop_meta(from);
  if (crop != nullptr) new_from_old *= windhover::CropOfPicture(crop->x, crop->y);
  return new_from_old;
}

gboolean TransformHomography(GstBuffer* to, GstMeta* meta, GstBuffer* from, GQuark type,
                             gpointer data) {
  const auto& old = *reinterpret_cast<GstWindhoverHomographyMeta*>(meta);
  if (GST_META_TRANSFORM_IS_COPY(type)) {
    if (static_cast<GstMetaTransformCopy*>(data)->region) return FALSE;
    return gst_buffer_add_windhover_homography_meta(to, old.registration, old.width, old.height) !=
           nullptr;
  }
  if (!GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) return FALSE;
  const auto& scale = *static_cast<GstVideoMetaTransform*>(data);
  const int width = GST_VIDEO_INFO_WIDTH(scale.out_info);
  const int height = GST_VIDEO_INFO_HEIGHT(scale.out_info);
  if (GST_VIDEO_INFO_WIDTH(scale.in_info) <= 0 || GST_VIDEO_INFO_HEIGHT(scale.in_info) <= 0 ||
      width <= 0 || height <= 0) {
    return FALSE;
  }
  const FrameRegistration scaled = windhover::RegistrationInNewPicture(
      old.registration, PictureTransform(from, scale), old.width, old.height, width, height);
  return gst_buffer_add_windhover_homography_meta(to, scaled, width, height) != nullptr;
}

windhover::MetaDescription DescribeHomographyMeta() {
  static const char* tags[] = {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR,
                               GST_META_TAG_VIDEO_ORIENTATION_STR, nullptr};
  return {"GstWindhoverHomographyMetaAPI", "GstWindhoverHomographyMeta", tags, TransformHomography};
}

using Registration =
    windhover::MetaRegistration<GstWindhoverHomographyMeta, DescribeHomographyMeta>;

}  // namespace

GType gst_windhover_homography_meta_api_get_type() { return Registration::Api(); }

const GstMetaInfo* gst_windhover_homography_meta_get_info() { return Registration::Info(); }

GstWindhoverHomographyMeta* gst_buffer_add_windhover_homography_meta(
    GstBuffer* buffer, const FrameRegistration& registration, int width, int height) {
  GstMeta* added = gst_buffer_add_meta(buffer, Registration::Info(), nullptr);
  auto* meta = reinterpret_cast<GstWindhoverHomographyMeta*>(added);
  if (meta == nullptr) return nullptr;
  meta->registration = registration;
  meta->width = width;
  meta->height = height;
  return meta;
}

GstWindhoverHomographyMeta* gst_buffer_get_windhover_homography_meta(GstBuffer* buffer) {
  return Registration::Of(buffer);
}
