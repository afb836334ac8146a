// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/backend.h"

namespace windhover::replay {

// A backend whose operators are those of `backend`, and tell `observe` what each run took by the
// clock of the host: "warp", "transform 36 x 128x64" and so on. Its images are those of `backend`.
std::shared_ptr<Backend> MakeTimedBackend(std::shared_ptr<Backend> backend,
                                          const StageObserver& observe);

}  // namespace windhover::replay
