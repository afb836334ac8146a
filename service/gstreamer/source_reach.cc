// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/source_reach.h"

#include <spdlog/fmt/fmt.h>

namespace windhover {
namespace {

constexpr std::int64_t kCutOffNs = 500'000'000;

}  // namespace

std::string CutOff(const SourceReach& reach) {
  if (reach.missing_bytes > 0) {
    return fmt::format("is cut off: {} bytes are missing; it ends after {:.2f} s, {} frames",
                       reach.missing_bytes, 1e-9 * reach.reached_ns, reach.frames);
  }
  if (reach.length_ns - reach.reached_ns < kCutOffNs) return "";
  return fmt::format("is cut off: it ends after {:.2f} s of {:.2f} s, {} frames",
                     1e-9 * reach.reached_ns, 1e-9 * reach.length_ns, reach.frames);
}

}  // namespace windhover
