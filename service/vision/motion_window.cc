// SPDX-License-Identifier: Apache-2.0
#include "service/vision/motion_window.h"

#include <algorithm>
#include <bit>

namespace windhover {

void BitPlane::Reset(int width, int height) {
  width_ = width;
  height_ = height;
  stride_ = (width + 31) / 32;
  words_.assign(static_cast<std::size_t>(stride_) * height, 0U);
}

void BitRuns::Collect(const BitView& bits) {
  runs.clear();
  row_begin.resize(bits.height + 1);
  const int words = bits.words_per_row();
  for (int y = 0; y < bits.height; ++y) {
    row_begin[y] = static_cast<int>(runs.size());
    const std::uint32_t* row = bits.row(y);
    int open = -1;  // first pixel of the run that reaches into this word
    for (int i = 0; i < words; i += 2) {
      std::uint64_t word = row[i];
      if (i + 1 < words) word |= static_cast<std::uint64_t>(row[i + 1]) << 32;
      if (word == (open < 0 ? 0 : ~std::uint64_t{0})) continue;
      int bit = 0;
      while (bit < 64) {
        if (open < 0) {
          const std::uint64_t rest = word >> bit;
          if (rest == 0) break;
          bit += std::countr_zero(rest);
          open = 32 * i + bit;
        }
        bit += std::countr_one(word >> bit);
        if (bit >= 64) break;
        runs.push_back({y, open, 32 * i + bit - 1});
        open = -1;
      }
    }
    if (open >= 0) runs.push_back({y, open, bits.width - 1});
  }
  row_begin[bits.height] = static_cast<int>(runs.size());
}

}  // namespace windhover
