// SPDX-License-Identifier: Apache-2.0
#include "replay/render/scenes/city.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// A spot of an area: shares of its half length and half width.
Vector2d SpotOf(const Area& area, double along, double across) {
  return area.centre + 0.5 * area.length * along * area.forward +
         0.5 * area.width * across * Right(area.forward);
}

}  // namespace

Random City::RandomFor(Piece piece, int index) const {
  return Random(Mix(seed_, Mix(0xC179 + static_cast<std::uint64_t>(piece),
                               static_cast<std::uint64_t>(index) + 0x10000)));
}

Facade City::RandomFacade(Random& random, bool tall) const {
  static constexpr std::array<Colour, 6> kWalls = {{{176, 188, 194},
                                                    {150, 168, 184},
                                                    {128, 142, 168},
                                                    {196, 200, 202},
                                                    {148, 150, 150},
                                                    {110, 128, 160}}};
  const double pick = random.Uniform();
  Facade facade;
  facade.colour = kWalls[random.Below(kWalls.size())];
  facade.floor = static_cast<float>(random.Uniform(2.8, 3.5));
  facade.bay = static_cast<float>(random.Uniform(2.4, 3.6));
  if (!tall) return facade;
  if (pick < 0.3) {
    facade.kind = FacadeKind::kBalconies;
  } else if (pick < 0.55) {
    facade.kind = FacadeKind::kBands;
  } else if (pick < 0.75) {
    facade.kind = FacadeKind::kGlass;
    facade.colour = {150, 126, 98};
    facade.bay = 1.6F;
  }
  return facade;
}

void City::AddTowers(const Area& block, double low, double high, int index) {
  Random random = RandomFor(Piece::kTowers, index);
  scene_.plots.push_back({block, GroundKind::kSlabs, {150, 156, 162}, random.Uniform(0.9, 1.6)});
  const int towers = random.Chance(0.65) ? 2 : 1;
  for (int i = 0; i < towers; ++i) {
    const double side = towers == 1 ? random.Uniform(-0.2, 0.2) : (i == 0 ? -0.48 : 0.48);
    const Vector2d centre = SpotOf(block, side, random.Uniform(-0.25, 0.25));
    const bool across = random.Chance(0.5);
    const double height = random.Uniform(low, high);
    const Facade facade = RandomFacade(random, true);
    const double length = std::min(random.Uniform(22, 30), 0.42 * block.length);
    const Vector2d forward = across ? block.forward : Right(block.forward);
    const auto tone = static_cast<float>(random.Uniform(-22, 22));
    const Colour roof = {128 + tone, 130 + tone, 132 + tone};
    if (random.Chance(0.6)) {  // a podium of shops
      scene_.buildings.push_back({{centre, forward, length + 12, 32},
                                  random.Uniform(6, 10),
                                  0.9,
                                  RoofKind::kFlat,
                                  roof,
                                  {FacadeKind::kBands, {160, 166, 170}}});
    }
    scene_.buildings.push_back({{centre, forward, length, random.Uniform(18, 24)},
                                height,
                                1.2,
                                RoofKind::kFlat,
                                roof,
                                facade});
    // The house for the lifts.
    scene_.buildings.push_back({{centre + random.Uniform(-4, 4) * forward, forward, 8, 6},
                                height + 3.5,
                                0.3,
                                RoofKind::kFlat,
                                {104, 108, 112},
                                {FacadeKind::kBlank, {140, 144, 148}}});
    if (random.Chance(0.4)) {
      scene_.poles.push_back({centre + 5 * Right(forward), 0.15, height + 11, {90, 90, 190}});
    }
  }
  for (int i = 0; i < 12; ++i) {
    pieces_.AddTree(SpotOf(block, random.Uniform(-0.95, 0.95), random.Chance(0.5) ? 0.9 : -0.9),
                    random.Uniform(1.4, 2.8));
  }
  for (int i = 0; i < 5; ++i) {
    const Area planter = {SpotOf(block, random.Uniform(-0.9, 0.9), random.Uniform(-0.9, 0.9)),
                          block.forward, random.Uniform(3, 8), 1.6};
    scene_.hedges.push_back({planter, 0.9});
  }
}

void City::AddPerimeter(const Area& block, double low, double high, int index) {
  Random random = RandomFor(Piece::kPerimeter, index);
  constexpr double kDeep = 12;
  scene_.plots.push_back({block, GroundKind::kPaved, {122, 126, 130}});
  const Vector2d forward = block.forward;
  const Vector2d right = Right(forward);
  const auto wing = [&](const Vector2d& from, const Vector2d& along, double length) {
    for (double at = 0; at < length - 6;) {
      const double piece = std::min(random.Uniform(12, 24), length - at);
      const bool gap = random.Chance(0.08);
      const Vector2d centre = from + (at + 0.5 * piece) * along;
      at += piece;
      if (gap) continue;
      const bool flat = random.Chance(0.35);
      const Facade facade = RandomFacade(random, false);
      scene_.buildings.push_back({{centre, along, piece, kDeep},
                                  random.Uniform(low, high),
                                  flat ? 0.7 : random.Uniform(2.6, 4.2),
                                  flat ? RoofKind::kFlat : RoofKind::kGable,
                                  flat ? Colour{132, 136, 140} : pieces_.RoofColour(),
                                  facade});
    }
  };
  const double in = 0.5 * kDeep;
  const double side = 0.5 * block.width - in;
  wing(block.centre - 0.5 * block.length * forward - side * right, forward, block.length);
  wing(block.centre - 0.5 * block.length * forward + side * right, forward, block.length);
  const double rest = block.width - 2 * kDeep;
  if (rest > 8) {
    const double end = 0.5 * block.length - in;
    wing(block.centre - end * forward - 0.5 * rest * right, right, rest);
    wing(block.centre + end * forward - 0.5 * rest * right, right, rest);
  }
  // The yard.
  const Area yard = {block.centre, forward, block.length - 2 * kDeep - 4, rest - 4};
  if (yard.length < 8 || yard.width < 6) return;
  scene_.plots.push_back({yard, GroundKind::kLawn, {64, 104, 92}});
  for (int i = 0; i < 9; ++i) {
    pieces_.AddTree(SpotOf(yard, random.Uniform(-0.9, 0.9), random.Uniform(-0.9, 0.9)),
                    random.Uniform(1.2, 3.4));
  }
  scene_.buildings.push_back({{SpotOf(yard, random.Uniform(-0.6, 0.6), 0.7), forward, 14, 5},
                              2.6,
                              0.2,
                              RoofKind::kFlat,
                              {118, 122, 126}});
  for (int i = 0; i < 6; ++i) {
    if (random.Chance(0.6)) {
      pieces_.AddParked(SpotOf(yard, -0.8 + 0.3 * i, -0.55), right);
    }
  }
}

void City::AddPark(const Area& block, int index) {
  Random random = RandomFor(Piece::kPark, index);
  scene_.plots.push_back({block, GroundKind::kLawn, {58, 112, 88}});
  Area path = block;
  path.width = 2.6;
  path.forward = (block.forward + random.Uniform(-0.5, 0.5) * Right(block.forward)).normalized();
  scene_.plots.push_back({path, GroundKind::kGravel, {136, 152, 160}});
  path.forward = Right(path.forward);
  path.length = block.width;
  scene_.plots.push_back({path, GroundKind::kGravel, {136, 152, 160}});
  const int trees = static_cast<int>(block.length * block.width / 75);
  for (int i = 0; i < trees; ++i) {
    pieces_.AddTree(SpotOf(block, random.Uniform(-0.95, 0.95), random.Uniform(-0.95, 0.95)),
                    random.Uniform(1.6, 4.6));
  }
}

void City::AddParkedRows(const Path& street, double right, double taken, int index) {
  Random random = RandomFor(Piece::kRows, index);
  for (const double side : {-right, right}) {
    for (double at = 4; at < street.length() - 4; at += 5.9) {
      const bool here = random.Chance(taken);
      const double off = random.Uniform(-0.25, 0.25);
      if (!here) continue;
      const Path::Place place = street.At(at + off, side + 0.3 * off);
      pieces_.AddParked(place.position, place.forward);
    }
  }
}

void City::AddLamps(const Path& street, double right, double spacing) {
  for (double at = 0.5 * spacing; at < street.length(); at += spacing) {
    const Path::Place place = street.At(at, right);
    Pole pole;
    pole.centre = place.position;
    pole.height = 8.5;
    pole.arm_m = 2.4;
    pole.arm = (right > 0 ? -1.0 : 1.0) * Right(place.forward);
    scene_.poles.push_back(pole);
  }
}

void City::AddClutter(const Path& street, double right, int index) {
  Random random = RandomFor(Piece::kClutter, index);
  for (double at = 3; at < street.length(); at += random.Uniform(7, 19)) {
    const Path::Place place = street.At(at, right + random.Uniform(-0.6, 0.6));
    const double pick = random.Uniform();
    if (pick < 0.3) {
      scene_.walls.push_back({{place.position, place.forward, random.Uniform(1, 5), 0.4}, 1.1});
    } else if (pick < 0.6) {
      scene_.walls.push_back({{place.position, place.forward, 1.4, 1.1}, 1.4, {62, 92, 60}});
    } else if (pick < 0.85) {
      scene_.poles.push_back({place.position, 0.08, 3.2, {150, 150, 152}});
    } else {
      scene_.canopies.push_back(
          {{place.position, place.forward, 4.2, 1.6}, 2.5, false, {126, 122, 116}});
    }
  }
}

void AddStreets(const StreetGrid& grid, std::uint64_t seed, Scene& scene, Settlement& pieces) {
  constexpr double kPeriod = 14;
  constexpr double kGreen = 5.5;
  const double stop_x = 0.5 * grid.width_y + 6;
  const double stop_y = 0.5 * grid.width_x + 6;
  const auto shift = [seed](std::size_t i, std::size_t j) {
    return Random(Mix(seed, Mix(0x116475 + i, j))).Uniform(0, kPeriod);
  };
  const auto lanes = [&](const Path& path, double width, int count, double spacing,
                         const std::vector<Lane::Light>& lights, double stop) {
    const double lane = width / count;
    for (int i = 0; i < count / 2; ++i) {
      pieces.AddLanes(path, (i + 0.5) * lane, spacing, grid.speed_low, grid.speed_high, lights,
                      stop);
    }
  };
  for (std::size_t i = 0; i < grid.along_x.size(); ++i) {
    const double y = grid.along_x[i];
    const Path path({{grid.low_x, y}, {grid.high_x, y}});
    scene.roads.push_back({path, grid.width_x, grid.lanes_x, grid.pavement, true});
    std::vector<Lane::Light> lights;
    for (std::size_t j = 0; j < grid.along_y.size(); ++j) {
      lights.push_back({grid.along_y[j] - grid.low_x - stop_x, kPeriod, shift(i, j) + kGreen + 1.5,
                        kPeriod - kGreen - 3});
    }
    lanes(path, grid.width_x, grid.lanes_x, grid.spacing_x, lights, stop_x);
  }
  for (std::size_t j = 0; j < grid.along_y.size(); ++j) {
    const double x = grid.along_y[j];
    const Path path({{x, grid.low_y}, {x, grid.high_y}});
    scene.roads.push_back({path, grid.width_y, grid.lanes_y, grid.pavement, true});
    std::vector<Lane::Light> lights;
    for (std::size_t i = 0; i < grid.along_x.size(); ++i) {
      lights.push_back({grid.along_x[i] - grid.low_y - stop_y, kPeriod, shift(i, j), kGreen});
      scene.junctions.push_back(
          {{{x, grid.along_x[i]}, Vector2d::UnitX(), grid.width_y + 1, grid.width_x + 1}});
    }
    lanes(path, grid.width_y, grid.lanes_y, grid.spacing_y, lights, stop_y);
  }
}

}  // namespace windhover::replay
