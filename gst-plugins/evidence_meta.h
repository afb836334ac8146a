// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <memory>

#include "service/vision/motion_evidence.h"

namespace windhover {

// What whbackground hands to whmotion. Travels with copies of the buffer, but not through elements
// that scale, turn or crop the picture, as its images would not fit any more.
void AddEvidence(GstBuffer* buffer, std::shared_ptr<const MotionEvidence> evidence);

// Takes it off the buffer, so that its memory can be used again; null where there is none. `buffer`
// must be writable.
std::shared_ptr<const MotionEvidence> TakeEvidence(GstBuffer* buffer);

}  // namespace windhover
