// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/gst.h>

#include <functional>
#include <optional>
#include <string>

namespace windhover {

// What an error or a warning on a pipeline's bus says.
std::string TextOf(GstMessage* message);
// What our elements compute on, for people, where the message (have-context) tells it.
std::optional<std::string> DeviceOf(GstMessage* message);

// Waits until the stream ends and returns nothing, or until an element fails and returns what it
// says. Meanwhile calls `on_message` with each other message and `tick` about ten times a second,
// where they are given; they may throw.
std::string AwaitEnd(GstBus* bus, const std::function<void(GstMessage*)>& on_message = nullptr,
                     const std::function<void()>& tick = nullptr);

}  // namespace windhover
