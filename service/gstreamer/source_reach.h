// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace windhover {

// How far a source has come.
struct SourceReach {
  std::uint64_t frames = 0;
  // Time of the source up to which frames came in, its length (0 where it is not known), and the
  // bytes that are known to be missing at its end.
  std::int64_t reached_ns = 0;
  std::int64_t length_ns = 0;
  std::int64_t missing_bytes = 0;
};

// How far the source goes, where it ends half a second or more before its length; else empty.
std::string CutOff(const SourceReach& reach);

}  // namespace windhover
