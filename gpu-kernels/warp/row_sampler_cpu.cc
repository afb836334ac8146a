// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/warp/row_sampler_cpu.h"

#include <bit>
#include <cstring>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

// The homogeneous coordinates of a row are linear in its sample number.
struct RowLine {
  float u0, u_step;
  float v0, v_step;
  float w0, w_step;
};

struct PictureShape {
  int width;
  int height;
  int stride;
};

// The address of each sample's top left source pixel, its place between four source pixels, and
// whether it is seen. At the right and bottom border the fraction becomes 1 and all four pixels
// stay inside.
WINDHOVER_MULTIVERSION
void Locate(const RowLine& line, const PictureShape& shape, int length, std::int32_t* offsets,
            float* fraction_x, float* fraction_y, float* seen) {
  const float last_x = static_cast<float>(shape.width - 1);
  const float last_y = static_cast<float>(shape.height - 1);
  const int last_left = shape.width > 1 ? shape.width - 2 : 0;
  const int last_top = shape.height > 1 ? shape.height - 2 : 0;
  const int stride = shape.stride;
  const RowLine l = line;
  for (int i = 0; i < length; ++i) {
    const float x = static_cast<float>(i);
    const float w = l.w0 + l.w_step * x;
    const float inverse = 1.0F / w;
    const float u = (l.u0 + l.u_step * x) * inverse;
    const float v = (l.v0 + l.v_step * x) * inverse;
    const bool inside = (w > 0.0F) & (u >= 0.0F) & (v >= 0.0F) & (u <= last_x) & (v <= last_y);
    const float safe_u = inside ? u : 0.0F;
    const float safe_v = inside ? v : 0.0F;
    int left = static_cast<int>(safe_u);
    int top = static_cast<int>(safe_v);
    left = left < last_left ? left : last_left;
    top = top < last_top ? top : last_top;
    offsets[i] = top * stride + left;
    fraction_x[i] = safe_u - static_cast<float>(left);
    fraction_y[i] = safe_v - static_cast<float>(top);
    seen[i] = inside ? 1.0F : 0.0F;
  }
}

// The two pixels side by side at each address, the left one in the low byte, and the two below
// them.
static_assert(std::endian::native == std::endian::little);
void Gather(const std::uint8_t* picture, int to_next_row, const std::int32_t* offsets, int length,
            std::uint16_t* upper, std::uint16_t* lower) {
  for (int i = 0; i < length; ++i) {
    const std::uint8_t* pixel = picture + offsets[i];
    std::memcpy(&upper[i], pixel, 2);
    std::memcpy(&lower[i], pixel + to_next_row, 2);
  }
}

WINDHOVER_MULTIVERSION
void Interpolate(const std::uint16_t* upper, const std::uint16_t* lower, const float* fraction_x,
                 const float* fraction_y, const float* seen, int length, float* values) {
  for (int i = 0; i < length; ++i) {
    const int up = upper[i];
    const int low = lower[i];
    const float a = static_cast<float>(up & 0xff);
    const float b = static_cast<float>(up >> 8);
    const float c = static_cast<float>(low & 0xff);
    const float d = static_cast<float>(low >> 8);
    const float above = a + fraction_x[i] * (b - a);
    const float below = c + fraction_x[i] * (d - c);
    values[i] = seen[i] * (above + fraction_y[i] * (below - above));
  }
}

}  // namespace

void RowSampler::Sample(const MappedImage<const std::uint8_t>& picture,
                        const WarpCoefficients& picture_from_grid, int y, int length, float* values,
                        float* seen) {
  Reserve(length);
  const WarpCoefficients& h = picture_from_grid;
  const float row = static_cast<float>(y);
  const RowLine line = {h[1] * row + h[2], h[0], h[4] * row + h[5], h[3], h[7] * row + h[8], h[6]};
  const int stride = static_cast<int>(picture.stride());
  Locate(line, {picture.width(), picture.height(), stride}, length, offsets_.data(),
         fraction_x_.data(), fraction_y_.data(), seen);
  Gather(picture.data(), picture.height() > 1 ? stride : 0, offsets_.data(), length, upper_.data(),
         lower_.data());
  Interpolate(upper_.data(), lower_.data(), fraction_x_.data(), fraction_y_.data(), seen, length,
              values);
}

void RowSampler::Reserve(int length) {
  if (offsets_.size() >= static_cast<std::size_t>(length)) return;
  offsets_.resize(length);
  fraction_x_.resize(length);
  fraction_y_.resize(length);
  upper_.resize(length);
  lower_.resize(length);
}

}  // namespace windhover
