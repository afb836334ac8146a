// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include "service/vision/stabilisation.h"

namespace windhover {

// Gives the buffer of a stabilised picture the metadata of the frame that it shows:
//   homography          told for the screen (registration_transform.h)
//   regions of interest the upright box, clipped to the screen, around where the region's corners
//                       lie; left out where that is off the screen. In their structures, the
//                       members x_min, y_min, x_max, y_max and velocity_x, velocity_y (shares of
//                       the picture's size, double) follow
//   other metadata      copied, unless its tags say that it depends on the picture's size or
//                       orientation or on its memory
// `width` and `height` are the frame's and the screen's, px. `to` must be writable.
void CarryMetadata(GstBuffer* from, const ScreenPose& pose, int width, int height, GstBuffer* to);

}  // namespace windhover
