// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "gpu-kernels/backend.h"
#include "replay/format/frame_source.h"
#include "service/options/options.h"
#include "service/vision/types.h"

namespace windhover::replay {

// The product's own registration of a source's frames, of the first `most_frames` where that is not
// 0: one entry for each. Calls `on_frame` after each. Throws what the source and the device do.
std::vector<FrameRegistration> RegisterFrames(FrameSource& source,
                                              const std::shared_ptr<Backend>& backend,
                                              const RegistrationOptions& options, int most_frames,
                                              const std::function<void()>& on_frame);

}  // namespace windhover::replay
