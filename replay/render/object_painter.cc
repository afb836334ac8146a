// SPDX-License-Identifier: Apache-2.0
#include "replay/render/ground_painter.h"
#include "replay/render/painting.h"

namespace windhover::replay {
namespace {

Terrain::Height Centimetres(float metres, bool foliage) {
  const auto height = static_cast<Terrain::Height>(std::clamp(metres, 0.0F, 600.0F) * 100);
  return foliage ? static_cast<Terrain::Height>(height | Terrain::kFoliage)
                 : static_cast<Terrain::Height>(height & ~Terrain::kFoliage);
}

float Wrapped(float value, float period) { return value - period * std::floor(value / period); }

void PaintHedge(const Hedge& hedge, std::uint32_t seed, const Strip& strip) {
  const auto half = static_cast<float>(hedge.area.width / 2);
  ForEachSpot(strip, hedge.area, [&](Spot spot) {
    const float edge = half * (0.75F + 0.25F * Noise(spot.along / 0.8F, 0, seed));
    if (std::abs(spot.across) > edge) return;
    const float bump = Texture(spot.x, spot.y, 1.2F, 0.5F, 0.2F, seed + 1);
    spot.colour = Paint({42, 78, 60}, 1 + 0.3F * bump);
    spot.height = Centimetres(static_cast<float>(hedge.height) * (0.85F + 0.2F * bump), true);
  });
}

// Height of a roof over the eaves at a spot of the building.
float RoofHeight(const Building& building, float along, float across) {
  const auto half_length = static_cast<float>(building.area.length / 2);
  const auto half_width = static_cast<float>(building.area.width / 2);
  const auto rise = static_cast<float>(building.rise);
  const float side = 1 - std::abs(across) / half_width;
  switch (building.roof) {
    case RoofKind::kGable:
      return rise * side;
    case RoofKind::kHip:
      return rise * std::min(side, (half_length - std::abs(along)) / half_width);
    case RoofKind::kFlat:
      return std::max(std::abs(across) - half_width, std::abs(along) - half_length) > -0.35F ? rise
                                                                                             : 0;
  }
  return 0;
}

// A flat roof carries boxes of machinery and rows of skylights.
void FurnishFlatRoof(const Building& building, std::uint32_t seed, Spot& spot, float& height,
                     Colour& colour) {
  const float cell_x = std::floor(spot.along / 7);
  const float cell_y = std::floor(spot.across / 6);
  const float pick = Noise(cell_x * 1.31F + 0.5F, cell_y * 1.73F + 0.5F, seed + 71);
  const float x = Wrapped(spot.along, 7);
  const float y = Wrapped(spot.across, 6);
  const bool large = building.area.width > 10;
  if (large && pick > 0.22F && x > 2 && x < 4.4F && y > 2 && y < 3.8F) {
    height += 1.3F;
    colour = {166, 168, 168};
  } else if (large && pick < -0.2F && x > 1 && x < 6 && y > 2.4F && y < 3.6F) {
    height += 0.25F;
    colour = {196, 186, 172};
  }
}

void PaintBuilding(const Building& building, std::uint32_t seed, const Strip& strip) {
  const bool flat = building.roof == RoofKind::kFlat;
  ForEachSpot(strip, building.area, [&](Spot spot) {
    float height =
        static_cast<float>(building.eaves) + RoofHeight(building, spot.along, spot.across);
    Colour colour = building.colour;
    float light = 1 + 0.12F * Texture(spot.x, spot.y, 5, 1.1F, 0.3F, seed);
    if (flat) {
      FurnishFlatRoof(building, seed, spot, height, colour);
      if (Wrapped(spot.along, 4.0F) < 0.12F) light -= 0.08F;  // sheets
    } else {
      const float course = Wrapped(spot.across, 0.42F);  // tiles
      const float joint = Wrapped(spot.along + 0.16F * std::floor(spot.across / 0.42F), 0.33F);
      light += course < 0.14F ? -0.12F : 0.03F;
      light += joint < 0.09F ? -0.05F : 0.01F;
      if (std::abs(spot.across) < 0.16F) light += 0.12F;  // ridge
      const float chimney_x = spot.along - 0.22F * static_cast<float>(building.area.length);
      if (std::abs(chimney_x) < 0.4F && std::abs(spot.across - 0.9F) < 0.4F) {
        height = static_cast<float>(building.eaves + building.rise) + 0.7F;
        colour = {78, 90, 128};
      }
    }
    const Terrain::Height value = Centimetres(height, false);
    if (value < spot.height) return;
    spot.colour = Paint(colour, light);
    spot.height = value;
  });
}

// A crown: a dome with clumps of leaves, each lit and shaded later as any other surface.
void PaintTree(const Tree& tree, const Strip& strip) {
  const auto radius = static_cast<float>(tree.radius);
  const auto top = static_cast<float>(tree.height);
  const Area area = {tree.centre, Eigen::Vector2d::UnitX(), 2.6 * tree.radius, 2.6 * tree.radius};
  ForEachSpot(strip, area, [&](Spot spot) {
    const float ragged =
        1 + 0.22F * Noise(spot.x / (0.5F * radius), spot.y / (0.5F * radius), tree.seed) +
        0.12F * Noise(spot.x / 0.5F, spot.y / 0.5F, tree.seed + 1);
    const float reach = radius * ragged;
    const float distance2 = spot.along * spot.along + spot.across * spot.across;
    if (distance2 > reach * reach) return;
    const float dome = std::sqrt(1 - distance2 / (reach * reach));
    const float clumps = 0.6F * Noise(spot.x / 1.1F, spot.y / 1.1F, tree.seed + 2) +
                         0.4F * Noise(spot.x / 0.45F, spot.y / 0.45F, tree.seed + 3);
    const float height = top * (0.42F + 0.58F * dome) + 0.13F * top * clumps;
    const Terrain::Height value = Centimetres(std::max(height, 0.3F), true);
    if (value <= spot.height) return;
    const float leaves =
        1 + 0.22F * clumps + 0.2F * Noise(spot.x / 0.25F, spot.y / 0.25F, tree.seed + 4);
    spot.colour = Paint(tree.colour, leaves);
    spot.height = value;
  });
}

}  // namespace

void PaintObjects(const Scene& scene, const Strip& strip) {
  auto seed = static_cast<std::uint32_t>(scene.seed) * 131U;
  for (const Hedge& hedge : scene.hedges) PaintHedge(hedge, seed += 17, strip);
  for (const Building& building : scene.buildings) PaintBuilding(building, seed += 17, strip);
  for (const Tree& tree : scene.trees) PaintTree(tree, strip);
}

}  // namespace windhover::replay
