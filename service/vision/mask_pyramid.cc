// SPDX-License-Identifier: Apache-2.0
#include "service/vision/mask_pyramid.h"

#include <algorithm>

namespace windhover {
namespace {

constexpr int kReach = 2;  // px, of the pyramid's filter

std::size_t At(int x, int y, int width) { return static_cast<std::size_t>(y) * width + x; }

// 1 where all pixels are that the filter reaches, at every `step`-th pixel. Beyond the border there
// is nothing to mind.
void Narrow(const std::vector<std::uint8_t>& use, int width, int height, int step,
            std::vector<std::uint8_t>& across, std::vector<std::uint8_t>& narrow) {
  const int out_width = (width + step - 1) / step;
  const int out_height = (height + step - 1) / step;
  across.resize(At(0, height, out_width));
  for (int y = 0; y < height; ++y) {
    const auto row = use.begin() + static_cast<std::ptrdiff_t>(At(0, y, width));
    for (int x = 0; x < out_width; ++x) {
      const int first = std::max(0, step * x - kReach);
      const int last = std::min(width - 1, step * x + kReach);
      across[At(x, y, out_width)] = *std::min_element(row + first, row + last + 1);
    }
  }
  narrow.assign(At(0, out_height, out_width), 1);
  for (int y = 0; y < out_height; ++y) {
    const int last = std::min(height - 1, step * y + kReach);
    for (int v = std::max(0, step * y - kReach); v <= last; ++v) {
      for (int x = 0; x < out_width; ++x) {
        narrow[At(x, y, out_width)] &= across[At(x, v, out_width)];
      }
    }
  }
}

}  // namespace

void MaskPyramid::Build(const GrayImage* mask, int levels) {
  levels_.resize(levels);
  if (mask == nullptr) {
    for (std::vector<std::uint8_t>& level : levels_) level.clear();
    return;
  }
  int width = mask->width();
  int height = mask->height();
  all_.resize(At(0, height, width));
  const auto pixels = mask->Read();
  for (int y = 0; y < height; ++y) {
    std::transform(pixels.row(y), pixels.row(y) + width,
                   all_.begin() + static_cast<std::ptrdiff_t>(At(0, y, width)),
                   [](std::uint8_t value) -> std::uint8_t { return value != 0 ? 1 : 0; });
  }
  Narrow(all_, width, height, 1, across_, levels_[0]);
  for (int i = 1; i < levels; ++i) {
    Narrow(levels_[i - 1], width, height, 2, across_, levels_[i]);
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
}

}  // namespace windhover
