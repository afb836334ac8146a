// SPDX-License-Identifier: Apache-2.0
#include "replay/render/ground_painter.h"

#include "replay/render/painting.h"

namespace windhover::replay {
namespace {

constexpr Colour kAsphalt = {102, 102, 101};
constexpr Colour kOldAsphalt = {122, 123, 123};
constexpr Colour kPavement = {140, 146, 150};
constexpr Colour kLine = {214, 214, 210};

// What lies where nothing else does: grass in the plain, sand where there is relief.
void PaintMeadow(const Scene& scene, const Strip& strip) {
  const auto seed = static_cast<std::uint32_t>(scene.seed) * 977U;
  const bool sand = scene.relief.height_m > 0;
  const float patches = sand ? 10 : 22;
  const Colour dry = {scene.meadow[0] + patches, scene.meadow[1] + 0.8F * patches,
                      scene.meadow[2] + 1.7F * patches};
  const float contrast = sand ? 0.09F : 0.26F;
  for (int y = 0; y < strip.rows; ++y) {
    const auto my = static_cast<float>((strip.first_y + y) * strip.texel_m);
    for (int x = 0; x < strip.width; ++x) {
      const auto mx = static_cast<float>((strip.first_x + x) * strip.texel_m);
      const std::size_t i = static_cast<std::size_t>(y) * strip.width + x;
      const float drought = 0.5F + 0.5F * Texture(mx, my, 38, 9, 2.3F, seed);
      const float light = 1 + contrast * Texture(mx, my, 4.1F, 0.9F, 0.3F, seed + 7);
      strip.colours[i] = Paint(Between(scene.meadow, dry, drought), light);
      if (sand) strip.heights[i] = HeightOf(scene.GroundAt(mx, my));
    }
  }
}

void PaintPhoto(const Scene& scene, const GroundPhoto& photo, const Strip& strip) {
  for (int y = 0; y < strip.rows; ++y) {
    const double my = (strip.first_y + y) * strip.texel_m;
    for (int x = 0; x < strip.width; ++x) {
      const double mx = (strip.first_x + x) * strip.texel_m;
      const std::size_t i = static_cast<std::size_t>(y) * strip.width + x;
      strip.colours[i] = Paint(photo.At(mx, my, strip.texel_m), 1);
      strip.heights[i] = HeightOf(scene.GroundAt(static_cast<float>(mx), static_cast<float>(my)));
    }
  }
}

void PaintLawn(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  const Colour worn = {plot.colour[0] + 14, plot.colour[1] + 10, plot.colour[2] + 30};
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    const float wear = 0.5F + 0.6F * Texture(spot.x, spot.y, 7, 2.2F, 0.8F, seed);
    const float light = 1 + 0.2F * Texture(spot.x, spot.y, 2.4F, 0.7F, 0.28F, seed + 5);
    spot.colour = Paint(Between(plot.colour, worn, std::clamp(wear, 0.0F, 1.0F)), light);
  });
}

void PaintField(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  const auto rows = static_cast<float>(plot.row_m);
  const Colour soil = {84, 112, 134};
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    const float bend = 0.35F * Noise(spot.along / 13, spot.across / 13, seed);
    const float phase = Wrapped(spot.across + bend, rows) / rows;
    const float ridge = 1 - 2 * std::abs(phase - 0.5F);
    const float growth = 0.5F + 0.7F * Texture(spot.x, spot.y, 23, 6, 1.1F, seed + 3);
    // Wheel tracks of the sprayer, every 15 m.
    const float track = std::abs(Wrapped(spot.across, 15.0F) - 7.5F);
    const bool wheels = track > 0.75F && track < 1.15F;
    const float cover =
        wheels ? 0.12F : std::clamp(0.25F + 0.6F * ridge * growth + 0.3F * growth, 0.0F, 1.0F);
    const float light = 1 + 0.22F * Texture(spot.x, spot.y, 1.7F, 0.6F, 0.25F, seed + 9);
    spot.colour = Paint(Between(soil, plot.colour, cover), light);
  });
}

void PaintPaved(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  const auto bay = static_cast<float>(plot.row_m);
  const auto bay_length = static_cast<float>(plot.row_length_m);
  const auto half = static_cast<float>(plot.area.length / 2);
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    float light = 1 + 0.11F * Texture(spot.x, spot.y, 9, 1.6F, 0.25F, seed);
    const float stain = Noise(spot.x / 1.3F, spot.y / 1.3F, seed + 11);
    if (stain > 0.55F) light -= 0.35F * (stain - 0.55F);
    Colour colour = plot.colour;
    if (bay > 0) {
      const float phase = Wrapped(spot.along + half, bay);
      if (std::min(phase, bay - phase) < 0.07F && std::abs(spot.across) < bay_length / 2 - 0.2F) {
        colour = kLine;
      }
    }
    spot.colour = Paint(colour, light);
  });
}

void PaintGravel(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    spot.colour = Paint(plot.colour, 1 + 0.3F * Texture(spot.x, spot.y, 3, 0.6F, 0.22F, seed));
  });
}

// Slabs of stone, each of its own tone, in a grid or in rings of a pattern.
void PaintSlabs(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  const auto side = static_cast<float>(plot.row_m);
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    const float row = std::floor(spot.across / side);
    const float shift = 0.5F * side * (row - 2 * std::floor(row / 2));
    const float column = std::floor((spot.along + shift) / side);
    const float tone = Noise(column * 1.37F + 0.5F, row * 1.71F + 0.5F, seed + 3);
    const bool band = Wrapped(column, 8) < 1 || Wrapped(row, 8) < 1;
    float light = 1 + 0.09F * tone + 0.08F * Texture(spot.x, spot.y, 11, 2.1F, 0.2F, seed);
    if (band) light -= 0.16F;
    const float joint = std::min(Wrapped(spot.along + shift, side), Wrapped(spot.across, side));
    if (joint < 0.06F) light -= 0.15F;
    spot.colour = Paint(plot.colour, light);
  });
}

void PaintForestFloor(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    const float edge = static_cast<float>(std::min(plot.area.length / 2 - std::abs(spot.along),
                                                   plot.area.width / 2 - std::abs(spot.across)));
    if (edge < 3 + 3 * Noise(spot.x / 5, spot.y / 5, seed + 8)) return;
    const float moss = 0.5F + 0.5F * Texture(spot.x, spot.y, 12, 3, 0.8F, seed + 4);
    const Colour needles = {plot.colour[0] + 4, plot.colour[1] + 8, plot.colour[2] + 26};
    spot.colour = Paint(Between(plot.colour, needles, moss),
                        1 + 0.3F * Texture(spot.x, spot.y, 2.2F, 0.7F, 0.25F, seed));
  });
}

void PaintWater(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  ForEachSpot(strip, plot.area, [&](Spot spot) {
    spot.colour = Paint(plot.colour, 1 + 0.12F * Texture(spot.x, spot.y, 30, 9, 3, seed));
    spot.surface = Terrain::kWater;
    spot.height = 0;
  });
}

void PaintPlot(const Plot& plot, std::uint32_t seed, const Strip& strip) {
  switch (plot.kind) {
    case GroundKind::kLawn:
      return PaintLawn(plot, seed, strip);
    case GroundKind::kField:
      return PaintField(plot, seed, strip);
    case GroundKind::kPaved:
      return PaintPaved(plot, seed, strip);
    case GroundKind::kGravel:
      return PaintGravel(plot, seed, strip);
    case GroundKind::kSlabs:
      return PaintSlabs(plot, seed, strip);
    case GroundKind::kForest:
      return PaintForestFloor(plot, seed, strip);
    case GroundKind::kWater:
      return PaintWater(plot, seed, strip);
  }
}

}  // namespace

Colour AsphaltAt(float x, float y, float along, float across, float lane_width,
                 std::uint32_t seed) {
  const float age = 0.5F + 0.5F * Noise(along / 45, across / 9, seed + 21);
  Colour colour = Between(kAsphalt, kOldAsphalt, age);
  float light = 1 + 0.10F * Texture(x, y, 5, 0.8F, 0.2F, seed);
  const float in_lane = std::abs(Wrapped(across, lane_width) - lane_width / 2);
  if (std::abs(in_lane - 0.8F) < 0.35F) light -= 0.035F;  // wheel paths
  if (in_lane < 0.3F) light -= 0.05F * (0.5F + 0.5F * Noise(along / 8, across, seed + 4));  // oil
  const float cell =
      Noise(std::floor(along / 7.3F) * 1.7F, std::floor(across / 3.4F) * 2.3F, seed + 31);
  if (cell > 0.52F) light -= 0.13F;  // patches of new asphalt
  const float crack = std::abs(Noise(x / 3.1F, y / 3.1F, seed + 41));
  if (crack < 0.025F) light -= 0.17F;
  for (float& channel : colour) channel *= light;
  return colour;
}

namespace {

bool IsLine(float along, float across, const Road& road, float lane_width) {
  const auto half = static_cast<float>(road.width / 2);
  const float from_middle = std::abs(across);
  if (std::abs(from_middle - (half - 0.25F)) < 0.08F) return true;  // edge
  if (road.lanes > 2 && std::abs(from_middle - 0.16F) < 0.07F) return true;
  const bool dash = Wrapped(along, 9.0F) < 3.0F;
  if (road.lanes == 2) return dash && from_middle < 0.08F;
  const float to_divider = std::abs(from_middle - lane_width);
  return dash && to_divider < 0.08F;
}

void PaintRoad(const Road& road, std::uint32_t seed, const Strip& strip) {
  const auto half = static_cast<float>(road.width / 2);
  const auto lane_width = static_cast<float>(road.width / road.lanes);
  const std::vector<Eigen::Vector2d>& points = road.path.points();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[i] - points[i - 1];
    // Half a texel of overlap closes the seams between the pieces.
    const Area area = {0.5 * (points[i] + points[i - 1]), step.normalized(),
                       step.norm() + 2 * strip.texel_m, road.width + 2 * road.pavement};
    const auto start = static_cast<float>(road.path.at(i - 1) + 0.5 * step.norm());
    ForEachSpot(strip, area, [&](Spot spot) {
      const float along = start + spot.along;
      if (std::abs(spot.across) > half) {
        const float joint = std::min(Wrapped(along, 1.6F), Wrapped(spot.across, 1.6F));
        const float kerb = std::abs(spot.across) < half + 0.18F ? 1.12F : 1.0F;
        const float light = 1 + 0.12F * Texture(spot.x, spot.y, 6, 1.2F, 0.25F, seed + 3);
        spot.colour = Paint(kPavement, light * kerb * (joint < 0.08F ? 0.88F : 1.0F));
        return;
      }
      Colour colour = AsphaltAt(spot.x, spot.y, along, spot.across, lane_width, seed);
      if (road.marked && IsLine(along, spot.across, road, lane_width)) {
        const float wear = 0.75F + 0.35F * Noise(along / 0.7F, spot.across / 0.3F, seed + 51);
        colour = Between(colour, kLine, std::clamp(wear, 0.0F, 1.0F));
      }
      spot.colour = Paint(colour, 1);
    });
  }
}

void PaintJunction(const Junction& junction, std::uint32_t seed, const Strip& strip) {
  const Area& area = junction.area;
  // The crossings for people lie on all four sides, 3 m wide.
  Area reach = area;
  reach.length += 10;
  reach.width += 10;
  const auto half_length = static_cast<float>(area.length / 2);
  const auto half_width = static_cast<float>(area.width / 2);
  ForEachSpot(strip, reach, [&](Spot spot) {
    const bool in_length = std::abs(spot.along) < half_length;
    const bool in_width = std::abs(spot.across) < half_width;
    if (!in_length && !in_width) return;
    if (in_length && in_width) {
      spot.colour = Paint(AsphaltAt(spot.x, spot.y, spot.along, spot.across, 50, seed), 1);
      return;
    }
    const float out =
        in_length ? std::abs(spot.across) - half_width : std::abs(spot.along) - half_length;
    const float side = in_length ? spot.along : spot.across;
    const bool zebra = out > 1.0F && out < 3.8F && Wrapped(side, 1.0F) < 0.5F;
    const bool stop =
        out > 4.4F && out < 4.75F && (in_length ? side * spot.across : -side * spot.along) < 0;
    if (zebra || stop) {
      const float wear = 0.85F + 0.3F * Noise(spot.x / 0.5F, spot.y / 0.5F, seed + 61);
      spot.colour = Paint(kLine, wear);
    } else if (out < 4.75F) {
      spot.colour = Paint(AsphaltAt(spot.x, spot.y, spot.along, spot.across, 50, seed), 1);
    }
  });
}

}  // namespace

void PaintGround(const Scene& scene, const GroundPhoto* photo, const Strip& strip) {
  if (photo != nullptr) return PaintPhoto(scene, *photo, strip);
  const auto seed = static_cast<std::uint32_t>(scene.seed) * 31U;
  PaintMeadow(scene, strip);
  // Water last: what lies under water is not seen.
  for (const bool water : {false, true}) {
    for (std::size_t i = 0; i < scene.plots.size(); ++i) {
      if ((scene.plots[i].kind == GroundKind::kWater) != water) continue;
      PaintPlot(scene.plots[i], seed + static_cast<std::uint32_t>(i) * 101U, strip);
    }
    if (water) break;
    for (std::size_t i = scene.roads.size(); i-- > 0;) {
      PaintRoad(scene.roads[i], seed + static_cast<std::uint32_t>(i) * 211U, strip);
    }
    for (const Junction& junction : scene.junctions) PaintJunction(junction, seed, strip);
  }
}

}  // namespace windhover::replay
