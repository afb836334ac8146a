// SPDX-License-Identifier: Apache-2.0
#include "service/vision/smooth_pyramid.h"

#include <algorithm>
#include <array>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

template <typename T>
using FiveRows = std::array<const T*, 5>;

template <typename T>
inline void AddRows(const FiveRows<T>& rows, int width, float* sum) {
  const T *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4];
  for (int x = 0; x < width; ++x) {
    const float outer = static_cast<float>(a[x]) + static_cast<float>(e[x]);
    const float inner = static_cast<float>(b[x]) + static_cast<float>(d[x]);
    sum[x] = (outer + 4.0F * inner + 6.0F * static_cast<float>(c[x])) * (1.0F / 256.0F);
  }
}

WINDHOVER_MULTIVERSION
void SmoothDown(const FiveRows<std::uint8_t>& rows, int width, float* sum) {
  AddRows(rows, width, sum);
}

WINDHOVER_MULTIVERSION
void SmoothDown(const FiveRows<float>& rows, int width, float* sum) { AddRows(rows, width, sum); }

// `row` has two pixels more on either side, row[2] is the first; takes every `step`-th.
WINDHOVER_MULTIVERSION
void SmoothAcross(const float* row, int step, int width, float* smooth) {
  if (step == 1) {
    for (int x = 0; x < width; ++x) {
      smooth[x] = row[x] + row[x + 4] + 4.0F * (row[x + 1] + row[x + 3]) + 6.0F * row[x + 2];
    }
    return;
  }
  for (int x = 0; x < width; ++x) {
    const float* r = row + 2 * x;
    smooth[x] = r[0] + r[4] + 4.0F * (r[1] + r[3]) + 6.0F * r[2];
  }
}

// The border's pixels go on beyond it.
template <typename T, typename RowOf>
void Smooth(RowOf row_of, int width, int height, int step, std::vector<float>& padded,
            FloatPicture& smooth) {
  smooth.width = (width + step - 1) / step;
  smooth.height = (height + step - 1) / step;
  smooth.values.resize(static_cast<std::size_t>(smooth.width) * smooth.height);
  padded.resize(std::max<std::size_t>(padded.size(), width + 4));
  for (int y = 0; y < smooth.height; ++y) {
    FiveRows<T> rows;
    for (int i = 0; i < 5; ++i) rows[i] = row_of(std::clamp(step * y + i - 2, 0, height - 1));
    float* const inside = padded.data() + 2;
    SmoothDown(rows, width, inside);
    inside[-2] = inside[-1] = inside[0];
    inside[width] = inside[width + 1] = inside[width - 1];
    SmoothAcross(padded.data(), step, smooth.width, smooth.row(y));
  }
}

}  // namespace

void SmoothPyramid::Build(const GrayImage& picture, int levels) {
  levels_.resize(levels);
  const auto pixels = picture.Read();
  Smooth<std::uint8_t>([&](int y) { return pixels.row(y); }, pixels.width(), pixels.height(), 1,
                       row_, levels_[0]);
  for (int i = 1; i < levels; ++i) {
    const FloatPicture& below = levels_[i - 1];
    Smooth<float>([&](int y) { return below.row(y); }, below.width, below.height, 2, row_,
                  levels_[i]);
  }
}

}  // namespace windhover
