// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/evidence_meta.h"

#include <gst/video/video.h>

#include <utility>

#include "service/gstreamer/meta_registration.h"

namespace windhover {
namespace {

struct EvidenceMeta {
  GstMeta meta;
  std::shared_ptr<const MotionEvidence> evidence;
};

gboolean TransformEvidence(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  if (!GST_META_TRANSFORM_IS_COPY(type)) return FALSE;
  if (static_cast<GstMetaTransformCopy*>(data)->region) return FALSE;
  AddEvidence(to, reinterpret_cast<EvidenceMeta*>(meta)->evidence);
  return TRUE;
}

MetaDescription DescribeEvidenceMeta() {
  static const char* tags[] = {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR,
                               GST_META_TAG_VIDEO_ORIENTATION_STR, nullptr};
  return {"GstWindhoverEvidenceMetaAPI", "GstWindhoverEvidenceMeta", tags, TransformEvidence};
}

using Registration = MetaRegistration<EvidenceMeta, DescribeEvidenceMeta>;

}  // namespace

void AddEvidence(GstBuffer* buffer, std::shared_ptr<const MotionEvidence> evidence) {
  GstMeta* meta = gst_buffer_add_meta(buffer, Registration::Info(), nullptr);
  reinterpret_cast<EvidenceMeta*>(meta)->evidence = std::move(evidence);
}

std::shared_ptr<const MotionEvidence> TakeEvidence(GstBuffer* buffer) {
  EvidenceMeta* meta = Registration::Of(buffer);
  if (meta == nullptr) return nullptr;
  std::shared_ptr<const MotionEvidence> evidence = std::move(meta->evidence);
  gst_buffer_remove_meta(buffer, &meta->meta);
  return evidence;
}

}  // namespace windhover
