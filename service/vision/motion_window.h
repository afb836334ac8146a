// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace windhover {

// Pictures as the motion filters see them: mapped, on the host, borrowed. Coordinates are pixels of
// the evidence's grid.

struct GrayView {
  const std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0;
  int height = 0;

  const std::uint8_t* row(int y) const { return data + y * stride; }
};

// One bit a pixel, 32 pixels a word, least significant bit first; bits past the width are 0.
struct BitView {
  const std::uint32_t* words = nullptr;
  std::ptrdiff_t stride = 0;  // words from one row to the next
  int width = 0;
  int height = 0;

  int words_per_row() const { return (width + 31) / 32; }
  const std::uint32_t* row(int y) const { return words + y * stride; }
  bool at(int x, int y) const { return (row(y)[x / 32] >> (x % 32) & 1U) != 0; }
  // 64 pixels of row y from x on, the first in the lowest bit. May reach outside, where there are
  // no set pixels.
  std::uint64_t Read(int x, int y) const {
    if (y < 0 || y >= height) return 0;
    const int index = x >> 5;
    const int shift = x & 31;
    const auto word = [&](int i) -> std::uint64_t {
      return i >= 0 && i < words_per_row() ? row(y)[i] : 0;
    };
    const std::uint64_t low = word(index) | word(index + 1) << 32;
    return shift == 0 ? low : low >> shift | word(index + 2) << (64 - shift);
  }
};

// A registered frame R_j and its motion seeds H_j (thesis 6.3).
struct WindowSample {
  BitView seeds;
  GrayView registered;
  int offset_frames = 0;  // from the centre frame
};

// A bit picture with memory of its own, laid out as BitView says.
class BitPlane {
 public:
  // All bits 0 afterwards. Allocates only where the plane grows.
  void Reset(int width, int height);

  std::uint32_t* row(int y) { return words_.data() + static_cast<std::ptrdiff_t>(y) * stride_; }
  BitView View() const { return {words_.data(), stride_, width_, height_}; }
  int width() const { return width_; }
  int height() const { return height_; }
  int words_per_row() const { return static_cast<int>(stride_); }

 private:
  std::vector<std::uint32_t> words_;
  std::ptrdiff_t stride_ = 0;
  int width_ = 0;
  int height_ = 0;
};

// Set pixels first <= x <= last of row y.
struct BitRun {
  int y = 0;
  int first = 0;
  int last = 0;
};

// The runs of a bit picture in scan order. Empty words cost next to nothing.
struct BitRuns {
  std::vector<BitRun> runs;
  // Index of the first run of each row, and the number of runs after the last row.
  std::vector<int> row_begin;

  void Collect(const BitView& bits);
};

}  // namespace windhover
