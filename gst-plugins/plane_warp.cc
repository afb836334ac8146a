// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/plane_warp.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cstdint>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

// Pixels of a row that are located together and then drawn.
constexpr int kBatch = 256;
constexpr int kMaxChannels = 4;
// Rounding must not take the border pixels from a picture that is drawn where it lies.
constexpr float kToleratedPx = 0.004F;

struct Source {
  const std::uint8_t* pixels;
  int width;
  int height;
  int stride;
  int channels;
};

// Homogeneous coordinates in the source along a row of the destination.
struct Line {
  float u, v, w;
  float u_step, v_step, w_step;
};

// For each pixel of a batch: its top left source pixel, the place between that and its neighbours
// in 1/256 px, and whether there is source at all.
struct Places {
  std::array<std::int32_t, kBatch> offset;
  std::array<std::int32_t, kBatch> fraction_x;
  std::array<std::int32_t, kBatch> fraction_y;
  std::array<std::int32_t, kBatch> inside;
};

WINDHOVER_MULTIVERSION
void Locate(const Line& line, const Source& source, int count, Places& places) {
  const Line l = line;
  const float last_x = static_cast<float>(source.width - 1);
  const float last_y = static_cast<float>(source.height - 1);
  const int last_left = source.width > 1 ? source.width - 2 : 0;
  const int last_top = source.height > 1 ? source.height - 2 : 0;
  const int stride = source.stride;
  const int channels = source.channels;
  for (int i = 0; i < count; ++i) {
    const float x = static_cast<float>(i);
    const float w = l.w + l.w_step * x;
    const float inverse = 1.0F / w;
    const float u = (l.u + l.u_step * x) * inverse;
    const float v = (l.v + l.v_step * x) * inverse;
    const bool inside = (w > 0.0F) & (u >= -kToleratedPx) & (v >= -kToleratedPx) &
                        (u <= last_x + kToleratedPx) & (v <= last_y + kToleratedPx);
    // In this order a coordinate that is no number becomes 0.
    float near_u = u > 0.0F ? u : 0.0F;
    float near_v = v > 0.0F ? v : 0.0F;
    near_u = near_u < last_x ? near_u : last_x;
    near_v = near_v < last_y ? near_v : last_y;
    int left = static_cast<int>(near_u);
    int top = static_cast<int>(near_v);
    left = left < last_left ? left : last_left;
    top = top < last_top ? top : last_top;
    places.offset[i] = top * stride + left * channels;
    places.fraction_x[i] = static_cast<int>((near_u - static_cast<float>(left)) * 256.0F + 0.5F);
    places.fraction_y[i] = static_cast<int>((near_v - static_cast<float>(top)) * 256.0F + 0.5F);
    places.inside[i] = inside ? 1 : 0;
  }
}

template <int kChannels>
void Draw(const Source& source, const Places& places, int count, Outside outside,
          const std::uint8_t* fill, std::uint8_t* out) {
  const int right = source.width > 1 ? kChannels : 0;
  const int below = source.height > 1 ? source.stride : 0;
  for (int i = 0; i < count; ++i, out += kChannels) {
    if (places.inside[i] == 0 && outside != Outside::kReplicate) {
      if (outside == Outside::kFill) std::copy_n(fill, kChannels, out);
      continue;
    }
    const std::uint8_t* pixel = source.pixels + places.offset[i];
    const int x = places.fraction_x[i];
    const int y = places.fraction_y[i];
    for (int c = 0; c < kChannels; ++c) {
      const int upper = pixel[c] * (256 - x) + pixel[c + right] * x;
      const int lower = pixel[c + below] * (256 - x) + pixel[c + below + right] * x;
      out[c] = static_cast<std::uint8_t>((upper * (256 - y) + lower * y + 32768) >> 16);
    }
  }
}

using DrawFunction = void (*)(const Source&, const Places&, int, Outside, const std::uint8_t*,
                              std::uint8_t*);
constexpr std::array<DrawFunction, kMaxChannels> kDraw = {Draw<1>, Draw<2>, Draw<3>, Draw<4>};

}  // namespace

void WarpPlane(const cv::Mat& source, const Eigen::Matrix3d& destination_from_source,
               Outside outside, const cv::Scalar& fill, cv::Mat& destination) {
  CV_Assert(source.type() == destination.type() && source.depth() == CV_8U &&
            source.channels() <= kMaxChannels && !source.empty());
  const int channels = source.channels();
  const Source from = {source.data, source.cols, source.rows, static_cast<int>(source.step),
                       channels};
  const DrawFunction draw = kDraw[static_cast<std::size_t>(channels - 1)];
  std::array<std::uint8_t, kMaxChannels> filling{};
  for (int c = 0; c < channels; ++c) filling[c] = cv::saturate_cast<std::uint8_t>(fill[c]);
  const Eigen::Matrix3d inverse = destination_from_source.inverse();
  const Eigen::Vector3f step = inverse.col(0).cast<float>();
  Places places;
  for (int y = 0; y < destination.rows; ++y) {
    for (int x = 0; x < destination.cols; x += kBatch) {
      const int count = std::min(kBatch, destination.cols - x);
      const Eigen::Vector3f at = (inverse * Eigen::Vector3d(x, y, 1.0)).cast<float>();
      Locate({at.x(), at.y(), at.z(), step.x(), step.y(), step.z()}, from, count, places);
      draw(from, places, count, outside, filling.data(), destination.ptr(y) + x * channels);
    }
  }
}

}  // namespace windhover
