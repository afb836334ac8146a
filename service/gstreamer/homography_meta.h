// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include "service/vision/types.h"

// How a video frame lies over the ground, as whregister measured it. Scaling and cropping elements
// that transform metadata keep the homographies right for the new picture.
struct GstWindhoverHomographyMeta {
  GstMeta meta;
  windhover::FrameRegistration registration;
  // Size in px of the picture that the homographies speak of.
  int width;
  int height;
};

// Registers "GstWindhoverHomographyMetaAPI" on first use; safe in several modules of one process.
GType gst_windhover_homography_meta_api_get_type();
const GstMetaInfo* gst_windhover_homography_meta_get_info();

// `buffer` must be writable.
GstWindhoverHomographyMeta* gst_buffer_add_windhover_homography_meta(
    GstBuffer* buffer, const windhover::FrameRegistration& registration, int width, int height);
// Null where there is none.
GstWindhoverHomographyMeta* gst_buffer_get_windhover_homography_meta(GstBuffer* buffer);
