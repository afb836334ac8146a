// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

namespace windhover {

// Posts the exception that is being handled as an error message of the element: OptionError as
// STREAM/FORMAT or, `while_starting`, LIBRARY/SETTINGS; UnsupportedVideo as STREAM/FORMAT;
// DeviceError as RESOURCE/FAILED or, `while_starting`, RESOURCE/NOT_FOUND; DdsError as
// RESOURCE/OPEN_WRITE; others as LIBRARY/FAILED. Call it in a catch block; never throws.
void PostCurrentException(GstElement* element, bool while_starting) noexcept;

}  // namespace windhover
