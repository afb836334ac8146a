// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/opencl/kernel.h"

namespace windhover::opencl {

// How kernels that go through a picture row by row are laid out on a device. Changes the speed, not
// the result.
struct RowLayout {
  // Pixels of 8 bits, and floats, that one vector holds.
  int byte_lanes = 4;
  int float_lanes = 1;
  // Whether a work-item does a whole row, or one group of pixels.
  bool whole_rows = false;

  // CPUs want few work-items with much to do, of the widest vectors there are; GPUs the opposite.
  static RowLayout For(const Context& context);

  // Work-items for rows of that many groups of pixels.
  WorkSize Size(std::size_t groups, std::size_t height) const;
};

// Compiles a source that takes its byte lanes as the macro V. OpenCL's vectors have up to 16; for
// more it needs a compiler with vectors of any size, as those for CPUs have. Where it refuses, 16
// are used.
Program CompileForByteLanes(Context& context, std::string_view source, const std::string& options,
                            int byte_lanes);

}  // namespace windhover::opencl
