// SPDX-License-Identifier: Apache-2.0
#include "replay/render/scenes/settlement.h"

#include <cmath>

namespace windhover::replay {

using Eigen::Vector2d;

Random Settlement::RandomFor(Piece piece) {
  const auto kind = static_cast<std::size_t>(piece);
  return Random(Mix(seed_, Mix(0x5E771E0 + kind, made_[kind]++)));
}

void Settlement::AddTree(const Vector2d& at, double radius) {
  Random random = RandomFor(Piece::kTree);
  const auto tone = static_cast<float>(random.Uniform(0.8, 1.15));
  const auto warm = static_cast<float>(random.Uniform(-7, 14));
  AddTree(at, radius, {44 * tone, 82 * tone, 66 * tone + warm});
}

void Settlement::AddTree(const Vector2d& at, double radius, const Colour& leaves) {
  Random random = RandomFor(Piece::kTree);
  scene_.trees.push_back({at, radius, radius * random.Uniform(1.7, 2.4), leaves,
                          static_cast<std::uint32_t>(random.Bits())});
}

void Settlement::AddWood(const Area& area, int count, double radius_low, double radius_high) {
  Random random = RandomFor(Piece::kWood);
  for (int i = 0; i < count; ++i) {
    const Vector2d at = area.centre + random.Uniform(-0.5, 0.5) * area.length * area.forward +
                        random.Uniform(-0.5, 0.5) * area.width * Right(area.forward);
    AddTree(at, random.Uniform(radius_low, radius_high));
  }
}

void Settlement::AddTreeRow(const Path& path, double right, double spacing, double radius_low,
                            double radius_high) {
  Random random = RandomFor(Piece::kRow);
  for (double at = 0; at < path.length(); at += spacing * random.Uniform(0.7, 1.4)) {
    if (random.Chance(0.12)) at += 3 * spacing;
    AddTree(path.At(at, right + random.Uniform(-0.4, 0.4)).position,
            random.Uniform(radius_low, radius_high));
  }
}

Colour Settlement::RoofColour() {
  static constexpr std::array<Colour, 6> kRoofs = {
      {{62, 76, 142}, {70, 84, 122}, {84, 84, 88}, {60, 62, 70}, {92, 112, 150}, {110, 116, 122}}};
  Random random = RandomFor(Piece::kRoof);
  Colour colour = kRoofs[random.Below(kRoofs.size())];
  const auto shift = static_cast<float>(random.Uniform(-9, 9));
  for (float& channel : colour) channel += shift;
  return colour;
}

void Settlement::AddParked(const Vector2d& at, const Vector2d& forward) {
  Random random = RandomFor(Piece::kParked);
  VehicleLook look = RandomVehicle(random);
  if (look.kind == VehicleKind::kTruck) look = RandomVehicle(random);
  const Vector2d ahead = random.Chance(0.4) ? Vector2d(-forward) : forward;
  const double turn = random.Uniform(-0.03, 0.03);
  scene_.parked.push_back({look, at, (ahead + turn * Right(ahead)).normalized()});
}

void Settlement::AddHouse(const Vector2d& centre, const Vector2d& street, double lot_width) {
  Random random = RandomFor(Piece::kHouse);
  const Vector2d along = Right(street);
  const double length = random.Uniform(9, 12.5);
  const double width = random.Uniform(7.5, 9.5);
  const bool ridge_along = random.Chance(0.65);
  const double turn = random.Uniform(-0.04, 0.04);
  const Vector2d ridge =
      ((ridge_along ? along : street) + turn * (ridge_along ? street : Vector2d(-along)));
  const auto tint = static_cast<float>(random.Uniform(-10, 12));
  scene_.plots.push_back({{centre - 4 * street, along, lot_width, 34},
                          GroundKind::kLawn,
                          {58 + 0.3F * tint, 102 + tint, 92 + 1.4F * tint}});
  scene_.buildings.push_back({{centre, ridge.normalized(), length, width},
                              random.Uniform(3.2, 5.6),
                              random.Uniform(2.0, 3.2),
                              random.Chance(0.25) ? RoofKind::kHip : RoofKind::kGable,
                              RoofColour()});
  const double side = random.Chance(0.5) ? 1 : -1;
  const Vector2d drive = centre + side * (0.5 * lot_width - 2.4) * along + 8.0 * street;
  scene_.plots.push_back({{drive, street, 12, 3.2},
                          random.Chance(0.5) ? GroundKind::kPaved : GroundKind::kGravel,
                          {136, 140, 144}});
  if (random.Chance(0.7)) AddParked(drive + random.Uniform(-2, 2) * street, street);
  if (random.Chance(0.6)) {  // garage or shed
    const Vector2d shed = centre + side * (0.5 * lot_width - 2.6) * along - 3.0 * street;
    scene_.buildings.push_back(
        {{shed, street, random.Uniform(4, 6), 3.2}, 2.3, 0.2, RoofKind::kFlat, RoofColour()});
  }
  scene_.hedges.push_back({{centre + 0.5 * lot_width * along - 6 * street, street, 24, 0.9}});
  AddGarden(centre - 13 * street, along, lot_width);
}

void Settlement::AddGarden(const Vector2d& centre, const Vector2d& along, double width) {
  Random random = RandomFor(Piece::kGarden);
  const Vector2d deep = Right(along);
  const auto spot = [&](double side, double low, double high) {
    return Vector2d(centre + random.Uniform(-side, side) * width * along +
                    random.Uniform(low, high) * deep);
  };
  for (int i = 1 + random.Below(4); i > 0; --i)
    AddTree(spot(0.45, -7, 6), random.Uniform(1.5, 3.4));
  for (int i = random.Below(7); i > 0; --i) AddTree(spot(0.5, -8, 9), random.Uniform(0.4, 0.9));
  if (random.Chance(0.4)) {  // path
    scene_.plots.push_back({{centre + random.Uniform(-4, 4) * along + 4 * deep, deep, 14, 1.1},
                            GroundKind::kGravel,
                            {134, 146, 154}});
  }
  if (random.Chance(0.5)) {  // vegetable beds
    scene_.plots.push_back({{centre + random.Uniform(-3, 3) * along, along, 5, 3.5},
                            GroundKind::kField,
                            {66, 84, 104},
                            0.9});
  }
  if (random.Chance(0.5)) {  // terrace
    scene_.plots.push_back({{centre + random.Uniform(-3, 3) * along + 7 * deep, along, 5, 3},
                            GroundKind::kPaved,
                            {150, 158, 164}});
  }
  if (random.Chance(0.12)) {  // pool
    scene_.plots.push_back({{centre, along, 6, 3.2}, GroundKind::kGravel, {176, 150, 92}});
  }
}

void Settlement::AddParking(const Vector2d& corner, int rows, int bays, double taken) {
  Random random = RandomFor(Piece::kParking);
  const double bay = 2.6;
  const double row = 5.2;
  const double pitch = 2 * row + 6.5;
  const double width = bays * bay;
  const double depth = rows * pitch;
  scene_.plots.push_back(
      {{corner + Vector2d(width / 2, depth / 2), Vector2d::UnitX(), width + 12, depth + 3},
       GroundKind::kPaved,
       {104, 105, 106}});
  for (int r = 0; r < rows; ++r) {
    for (const double offset : {0.0, row}) {
      const double y = corner.y() + r * pitch + 3.2 + offset + row / 2;
      scene_.plots.push_back({{{corner.x() + width / 2, y}, Vector2d::UnitX(), width, row},
                              GroundKind::kPaved,
                              {108, 109, 110},
                              bay,
                              row});
      for (int b = 0; b < bays; ++b) {
        const Vector2d at(corner.x() + (b + 0.5) * bay + random.Uniform(-0.15, 0.15),
                          y + random.Uniform(-0.3, 0.3));
        if (random.Chance(taken)) AddParked(at, {0, 1});
      }
    }
  }
}

void Settlement::AddField(const Area& area) {
  static constexpr std::array<Colour, 7> kCrops = {{{62, 128, 112},
                                                    {78, 112, 132},
                                                    {70, 146, 150},
                                                    {58, 100, 84},
                                                    {88, 124, 146},
                                                    {54, 118, 88},
                                                    {104, 158, 172}}};
  Random random = RandomFor(Piece::kField);
  scene_.plots.push_back(
      {area, GroundKind::kField, kCrops[random.Below(kCrops.size())], random.Uniform(0.8, 1.3)});
}

void Settlement::AddFarm(const Vector2d& centre, const Vector2d& forward) {
  Random random = RandomFor(Piece::kFarm);
  const Vector2d right = Right(forward);
  scene_.plots.push_back({{centre, forward, 52, 44}, GroundKind::kGravel, {118, 136, 148}});
  scene_.buildings.push_back({{centre - 16 * right, forward, random.Uniform(28, 36), 13},
                              5.5,
                              4.0,
                              RoofKind::kGable,
                              {66, 76, 118},
                              {FacadeKind::kBlank, {78, 96, 116}}});
  scene_.buildings.push_back({{centre + 14 * right - 8 * forward, forward, 22, 10},
                              4.5,
                              3.2,
                              RoofKind::kGable,
                              {104, 108, 112},
                              {FacadeKind::kBlank, {120, 134, 146}}});
  scene_.buildings.push_back({{centre + 20 * forward + 4 * right, right, 13, 9.5},
                              4.2,
                              3.0,
                              RoofKind::kHip,
                              RoofColour()});
  for (int i = 0; i < 3; ++i) {
    AddParked(centre + random.Uniform(-12, 12) * forward + random.Uniform(-6, 6) * right,
              random.Chance(0.5) ? forward : right);
  }
  for (int i = 0; i < 12; ++i) {
    const double side = random.Chance(0.5) ? 1 : -1;
    AddTree(centre + random.Uniform(-30, 30) * forward + side * random.Uniform(23, 30) * right,
            random.Uniform(1.6, 4.0));
  }
}

void Settlement::AddLanes(const Path& path, double lateral, double spacing, double speed_low,
                          double speed_high, const std::vector<Lane::Light>& lights,
                          double stop_distance) {
  scene_.lanes.push_back({path, lateral, spacing, speed_low, speed_high, lights, {}, {}});
  std::vector<Lane::Light> back;
  for (auto light = lights.rbegin(); light != lights.rend(); ++light) {
    back.push_back(*light);
    back.back().at_m = path.length() - light->at_m - 2 * stop_distance;
  }
  scene_.lanes.push_back({path.Reversed(), lateral, spacing, speed_low, speed_high, back, {}, {}});
}

}  // namespace windhover::replay
