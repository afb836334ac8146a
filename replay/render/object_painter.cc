// SPDX-License-Identifier: Apache-2.0
#include "replay/render/ground_painter.h"
#include "replay/render/painting.h"

namespace windhover::replay {
namespace {

constexpr float kLampHead = 0.35F;  // m, half the length of a lamp at the end of its arm

void Raise(Spot& spot, float height, float underside, Terrain::Surface surface) {
  spot.height = HeightOf(height);
  spot.surface = surface;
  spot.underside = static_cast<Terrain::Underside>(
      std::clamp(underside / Terrain::kUndersideUnit, 0.0F, 255.0F));
}

float BaseAt(const Scene& scene, const Eigen::Vector2d& spot) {
  return scene.GroundAt(static_cast<float>(spot.x()), static_cast<float>(spot.y()));
}

void PaintHedge(const Hedge& hedge, float base, std::uint32_t seed, const Strip& strip) {
  const auto half = static_cast<float>(hedge.area.width / 2);
  ForEachSpot(strip, hedge.area, [&](Spot spot) {
    const float edge = half * (0.75F + 0.25F * Noise(spot.along / 0.8F, 0, seed));
    if (std::abs(spot.across) > edge) return;
    const float bump = Texture(spot.x, spot.y, 1.2F, 0.5F, 0.2F, seed + 1);
    spot.colour = Paint({42, 78, 60}, 1 + 0.3F * bump);
    Raise(spot, base + static_cast<float>(hedge.height) * (0.85F + 0.2F * bump), 0,
          Terrain::kFoliage);
  });
}

void PaintWall(const Wall& wall, float base, std::uint32_t seed, const Strip& strip) {
  Area area = wall.area;
  area.width = std::max(area.width, 1.2 * strip.texel_m);
  ForEachSpot(strip, area, [&](Spot spot) {
    spot.colour = Paint(wall.colour, 1 + 0.2F * Texture(spot.x, spot.y, 6, 1.5F, 0.3F, seed));
    Raise(spot, base + static_cast<float>(wall.height), 0, Terrain::kSolid);
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

void PaintBuilding(const Building& building, Terrain::Surface surface, float base,
                   std::uint32_t seed, const Strip& strip) {
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
    if (HeightOf(base + height) < spot.height) return;
    spot.colour = Paint(colour, light);
    Raise(spot, base + height, 0, surface);
  });
}

void PaintCanopy(const Canopy& canopy, float base, std::uint32_t seed, const Strip& strip) {
  const auto top = base + static_cast<float>(canopy.height);
  const auto radius = static_cast<float>(canopy.area.length / 2);
  ForEachSpot(strip, canopy.area, [&](Spot spot) {
    float height = top;
    float light = 1 + 0.08F * Texture(spot.x, spot.y, 3, 0.8F, 0.3F, seed);
    if (canopy.round) {
      const float distance = std::sqrt(spot.along * spot.along + spot.across * spot.across);
      if (distance > radius) return;
      height += 0.35F * (1 - distance / radius);
      // Six panels of cloth, lit differently where the umbrella slopes.
      const bool seam = std::abs(spot.along) < 0.05F ||
                        std::abs(std::abs(spot.across) - 0.577F * std::abs(spot.along)) < 0.04F;
      if (seam) light -= 0.12F;
      if (distance < 0.06F) {
        Raise(spot, height, 0, Terrain::kSolid);
        return;
      }
    } else if (Wrapped(spot.along, 1.5F) < 0.1F) {
      light -= 0.12F;
    }
    spot.colour = Paint(canopy.colour, light);
    Raise(spot, height, height - 0.3F, Terrain::kSolid);
  });
}

void PaintPole(const Pole& pole, float base, const Strip& strip) {
  // At least a texel and a half wide, so that none falls between the texels.
  const double side = 2 * std::max(pole.radius, 0.75 * strip.texel_m);
  const auto top = base + static_cast<float>(pole.height);
  ForEachSpot(strip, {pole.centre, Eigen::Vector2d::UnitX(), side, side}, [&](Spot spot) {
    spot.colour = Paint(pole.colour, 1);
    Raise(spot, top, 0, Terrain::kSolid);
  });
  if (pole.arm_m <= 0) return;
  const Area arm = {pole.centre + (0.5 * pole.arm_m + 0.2) * pole.arm, pole.arm, pole.arm_m,
                    std::max(0.5, 1.2 * strip.texel_m)};
  const auto head = static_cast<float>(pole.arm_m / 2) - 2 * kLampHead;
  ForEachSpot(strip, arm, [&](Spot spot) {
    if (spot.along < head && std::abs(spot.across) > 0.6F * static_cast<float>(strip.texel_m))
      return;
    spot.colour = Paint(spot.along < head ? pole.colour : Colour{190, 192, 190}, 1);
    Raise(spot, top, top - 0.3F, Terrain::kSolid);
  });
}

// The deck and its parapets, and the grass of the banks it comes up on.
void PaintBridge(const Bridge& bridge, std::uint32_t seed, const Strip& strip) {
  constexpr float kBankSlope = 0.62F;  // fall a metre out
  constexpr float kParapet = 0.3F;     // m wide
  constexpr float kDeck = 1.3F;        // m thick
  const auto half = static_cast<float>(bridge.width / 2);
  const std::vector<Eigen::Vector2d>& points = bridge.path.points();
  double most = 0;
  for (const HeightKnot& knot : bridge.knots) most = std::max(most, knot.height_m);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[i] - points[i - 1];
    const double start = bridge.path.at(i - 1) + 0.5 * step.norm();
    const Area area = {0.5 * (points[i] + points[i - 1]), step.normalized(),
                       step.norm() + 2 * strip.texel_m, bridge.width + 2 * most / kBankSlope};
    ForEachSpot(strip, area, [&](Spot spot) {
      const double along = start + spot.along;
      const auto deck = static_cast<float>(HeightOfWay(bridge.knots, along));
      const float out = std::abs(spot.across) - half;
      const bool open = along > bridge.open_from_m && along < bridge.open_to_m;
      const float height = out <= 0 ? deck + (out > -kParapet ? 0.9F : 0) : deck - out * kBankSlope;
      if ((open && out > 0) || HeightOf(height) <= spot.height) return;
      Colour colour = {62, 104, 92};
      float light = 1 + 0.3F * Texture(spot.x, spot.y, 4, 0.9F, 0.3F, seed);
      if (out > -kParapet && out <= 0) {
        colour = {158, 162, 164};
        light = 1;
      } else if (out <= 0) {
        const auto way = static_cast<float>(along);
        const auto lane = static_cast<float>(bridge.lane_width);
        colour = AsphaltAt(spot.x, spot.y, way, spot.across, lane, seed);
        const bool edge = std::abs(out + kParapet + 0.5F) < 0.08F;
        const bool dash = Wrapped(way, 9) < 3 &&
                          std::abs(Wrapped(spot.across + lane / 2, lane) - lane / 2) < 0.08F;
        if (edge || dash) colour = {210, 210, 206};
        light = 1.04F;
      }
      spot.colour = Paint(colour, light);
      Raise(spot, height, open ? deck - kDeck : 0, Terrain::kSolid);
    });
  }
}

// A crown: a dome with clumps of leaves, each lit and shaded later as any other surface.
void PaintTree(const Tree& tree, float base, const Strip& strip) {
  const auto radius = static_cast<float>(tree.radius);
  const auto top = static_cast<float>(tree.height);
  const bool trunk = tree.trunk && top > 3;
  const float foot = 0.3F * top;
  const float thick = std::max(0.06F * radius + 0.08F, 0.75F * static_cast<float>(strip.texel_m));
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
    const float height = std::max(top * (0.42F + 0.58F * dome) + 0.13F * top * clumps, 0.3F);
    if (HeightOf(base + height) <= spot.height) return;
    const float leaves =
        1 + 0.22F * clumps + 0.2F * Noise(spot.x / 0.25F, spot.y / 0.25F, tree.seed + 4);
    spot.colour = Paint(tree.colour, leaves);
    const bool air = trunk && distance2 > thick * thick && height > foot + 0.5F;
    Raise(spot, base + height, air ? base + foot : 0,
          trunk && !air && distance2 <= thick * thick ? Terrain::kTrunk : Terrain::kFoliage);
  });
}

}  // namespace

void PaintObjects(const Scene& scene, const Strip& strip) {
  auto seed = static_cast<std::uint32_t>(scene.seed) * 131U;
  for (const Bridge& bridge : scene.bridges) PaintBridge(bridge, seed += 17, strip);
  for (const Hedge& hedge : scene.hedges) {
    PaintHedge(hedge, BaseAt(scene, hedge.area.centre), seed += 17, strip);
  }
  for (const Wall& wall : scene.walls) {
    PaintWall(wall, BaseAt(scene, wall.area.centre), seed += 17, strip);
  }
  for (std::size_t i = 0; i < scene.buildings.size(); ++i) {
    const Building& building = scene.buildings[i];
    const auto surface = static_cast<Terrain::Surface>(Terrain::kFirstBuilding + i);
    PaintBuilding(building, surface, BaseAt(scene, building.area.centre), seed += 17, strip);
  }
  for (const Canopy& canopy : scene.canopies) {
    PaintCanopy(canopy, BaseAt(scene, canopy.area.centre), seed += 17, strip);
  }
  for (const Pole& pole : scene.poles) PaintPole(pole, BaseAt(scene, pole.centre), strip);
  for (const Flag& flag : scene.flags) {
    PaintPole({flag.foot, 0.06, flag.height + 0.2}, BaseAt(scene, flag.foot), strip);
  }
  for (const Tree& tree : scene.trees) PaintTree(tree, BaseAt(scene, tree.centre), strip);
}

}  // namespace windhover::replay
