// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/row_layout.h"

namespace windhover::opencl {

RowLayout RowLayout::For(const Context& context) {
  if (!context.is_cpu()) return {};
  return {.byte_lanes = 64, .float_lanes = context.float_lanes(), .whole_rows = true};
}

WorkSize RowLayout::Size(std::size_t groups, std::size_t height) const {
  // Several rows a work-group, as starting one costs a CPU about what 100 pixels do.
  if (whole_rows) return {.global = {1, RoundUp(height, 8), 1}, .local = {1, 8, 1}};
  return {.global = {RoundUp(groups, 32), RoundUp(height, 4), 1}, .local = {32, 4, 1}};
}

Program CompileForByteLanes(Context& context, std::string_view source, const std::string& options,
                            int byte_lanes) {
  constexpr int kStandardLanes = 16;
  if (byte_lanes > kStandardLanes) {
    try {
      return context.Compile(source, options + " -DV=" + std::to_string(byte_lanes));
    } catch (const DeviceError&) {
      byte_lanes = kStandardLanes;
    }
  }
  return context.Compile(source, options + " -DV=" + std::to_string(byte_lanes));
}

}  // namespace windhover::opencl
