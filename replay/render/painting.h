// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "replay/render/ground_painter.h"
#include "replay/render/portable_math.h"

// What the painters of ground and objects share.

namespace windhover::replay {

inline std::uint32_t Pack(float blue, float green, float red, float alpha) {
  const auto byte = [](float value) {
    return static_cast<std::uint32_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F);
  };
  return byte(blue) | byte(green) << 8 | byte(red) << 16 | byte(alpha) << 24;
}

// `colour` times `light`, where 1 leaves it as it is.
inline std::uint32_t Paint(const Colour& colour, float light) {
  return Pack(colour[0] * light, colour[1] * light, colour[2] * light, 255.0F);
}

// Noise at three scales in metres: large patches, clumps, grains. About [-1, 1].
inline float Texture(float x, float y, float large, float middle, float small, std::uint32_t seed) {
  return 0.45F * Noise(x / large, y / large, seed) +
         0.33F * Noise(x / middle, y / middle, seed + 1) +
         0.22F * Noise(x / small, y / small, seed + 2);
}

// What asphalt looks like at a spot `across` from the middle of the road: worn by wheels, patched,
// cracked.
Colour AsphaltAt(float x, float y, float along, float across, float lane_width, std::uint32_t seed);

// One texel of an area: where it is on the map, and from the area's middle along and across it.
struct Spot {
  float x;
  float y;
  float along;
  float across;
  std::uint32_t& colour;
  Terrain::Height& height;
  Terrain::Surface& surface;
  Terrain::Underside& underside;
};

inline Terrain::Height HeightOf(float metres) {
  return static_cast<Terrain::Height>(
      std::clamp(metres, 0.0F, Terrain::kMostMetres) / Terrain::kHeightUnit + 0.5F);
}

inline float Wrapped(float value, float period) {
  return value - period * std::floor(value / period);
}

// Calls visit(Spot) for each texel of the strip that lies in the area.
template <typename Visit>
void ForEachSpot(const Strip& strip, const Area& area, Visit&& visit) {
  const Eigen::Vector2d right = Right(area.forward);
  const double reach_x =
      0.5 * (std::abs(area.forward.x()) * area.length + std::abs(right.x()) * area.width);
  const double reach_y =
      0.5 * (std::abs(area.forward.y()) * area.length + std::abs(right.y()) * area.width);
  const auto texel = [&strip](double metres) {
    return static_cast<int>(std::floor(std::clamp(metres / strip.texel_m, -1e8, 1e8)));
  };
  const int x0 = std::max(strip.first_x, texel(area.centre.x() - reach_x));
  const int x1 = std::min(strip.first_x + strip.width - 1, texel(area.centre.x() + reach_x) + 1);
  const int y0 = std::max(strip.first_y, texel(area.centre.y() - reach_y));
  const int y1 = std::min(strip.first_y + strip.rows - 1, texel(area.centre.y() + reach_y) + 1);
  const auto half_length = static_cast<float>(area.length / 2);
  const auto half_width = static_cast<float>(area.width / 2);
  const Eigen::Vector2f forward = area.forward.cast<float>();
  for (int y = y0; y <= y1; ++y) {
    const auto dy = static_cast<float>(y * strip.texel_m - area.centre.y());
    const std::size_t row = static_cast<std::size_t>(y - strip.first_y) * strip.width;
    for (int x = x0; x <= x1; ++x) {
      const auto dx = static_cast<float>(x * strip.texel_m - area.centre.x());
      const float along = forward.x() * dx + forward.y() * dy;
      const float across = forward.x() * dy - forward.y() * dx;
      if (std::abs(along) > half_length || std::abs(across) > half_width) continue;
      const std::size_t i = row + (x - strip.first_x);
      visit(Spot{dx + static_cast<float>(area.centre.x()), dy + static_cast<float>(area.centre.y()),
                 along, across, strip.colours[i], strip.heights[i], strip.surfaces[i],
                 strip.undersides[i]});
    }
  }
}

}  // namespace windhover::replay
