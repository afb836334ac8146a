// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: blocks of houses between streets along x and along y, and fields that cut in
// where the town thins out.
constexpr double kWest = -260;
constexpr double kRow = 74;  // from street to street
constexpr double kRows = 3;  // streets to either side of the middle one
constexpr double kLot = 18;
constexpr double kBlock = 160;  // from cross street to cross street

class Suburb {
 public:
  explicit Suburb(const FlightPlan& plan)
      : pieces_(plan.seed, scene_),
        random_(Mix(plan.seed, 0x50B0)),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 330) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.5, 0.55, 0.82).normalized();
    scene_.meadow = {66, 110, 104};
  }

  Scene Build() {
    for (double x = kWest; x < east_; x += kBlock) BuildBlocks(x);
    BuildStreets();
    return std::move(scene_);
  }

 private:
  // Streets follow the land a little.
  static double StreetY(double row, double x) {
    return row * kRow + 9 * Sine(x / 170 + 0.7 * row) + 2.5 * Sine(x / 53 + row);
  }

  void BuildBlocks(double x) {
    for (double row = -kRows; row < kRows; row += 1) {
      const double pick = random_.Uniform();
      const double middle = x + 0.5 * kBlock;
      const double y = 0.5 * (StreetY(row, middle) + StreetY(row + 1, middle));
      if (pick < 0.22) {
        const Vector2d forward = Vector2d(1, random_.Uniform(-0.1, 0.1)).normalized();
        pieces_.AddField({{middle, y}, forward, kBlock - 22, kRow - 18});
        pieces_.AddTreeRow(Path({{x + 10, y + 31}, {x + kBlock - 10, y + 31}}), 0, 15, 1.8, 3.6);
      } else if (pick < 0.32) {
        const Area area = {{middle, y}, Vector2d::UnitX(), kBlock - 24, kRow - 18};
        scene_.plots.push_back({area, GroundKind::kLawn, {56, 108, 86}});
        pieces_.AddWood(area, 70, 1.6, 4.4);
      } else if (pick < 0.42) {
        BuildSchool({middle, y});
      } else {
        BuildHouses(x, row);
      }
    }
  }

  void BuildHouses(double x, double row) {
    for (double at = x + 20; at < x + kBlock - 16; at += kLot) {
      if (!random_.Chance(0.06)) {
        pieces_.AddHouse({at, StreetY(row, at) + 16 + random_.Uniform(-1, 1)}, {0, -1}, kLot);
      }
      if (!random_.Chance(0.06)) {
        pieces_.AddHouse({at, StreetY(row + 1, at) - 16 + random_.Uniform(-1, 1)}, {0, 1}, kLot);
      }
      if (random_.Chance(0.55)) {
        const double side = random_.Chance(0.5) ? 1 : -1;
        pieces_.AddParked({at + random_.Uniform(-5, 5), StreetY(row, at) + side * 3.8}, {1, 0});
      }
    }
  }

  void BuildSchool(const Vector2d& centre) {
    scene_.plots.push_back(
        {{centre, Vector2d::UnitX(), kBlock - 26, kRow - 22}, GroundKind::kPaved, {124, 126, 128}});
    scene_.plots.push_back(
        {{centre + Vector2d(34, 0), Vector2d::UnitX(), 60, 40}, GroundKind::kLawn, {60, 124, 82}});
    scene_.buildings.push_back({{centre + Vector2d(-34, -10), Vector2d::UnitX(), 52, 15},
                                8,
                                0.6,
                                RoofKind::kFlat,
                                {132, 134, 138}});
    scene_.buildings.push_back({{centre + Vector2d(-52, 9), Vector2d::UnitY(), 24, 13},
                                6,
                                0.5,
                                RoofKind::kFlat,
                                {112, 118, 128}});
    for (int i = 0; i < 9; ++i) {
      if (random_.Chance(0.7)) pieces_.AddParked(centre + Vector2d(-40 + 2.8 * i, 18), {0, 1});
    }
  }

  void BuildStreets() {
    for (double x = kWest; x < east_; x += kBlock) {
      const double shift = random_.Uniform(-6, 6);
      const Path cross(
          {{x + shift, StreetY(-kRows, x) - 200}, {x, 0}, {x - shift, StreetY(kRows, x) + 200}});
      scene_.roads.push_back({cross, 6.4, 2, 1.5, false});
      pieces_.AddLanes(cross, 1.6, 230, 8, 12);
      for (double row = -kRows; row <= kRows; row += 1) {
        scene_.junctions.push_back({{{x, StreetY(row, x)}, Vector2d::UnitX(), 8, 8}});
      }
    }
    for (double row = -kRows; row <= kRows; row += 1) {
      const Path street =
          LineAlongX(kWest - 250, east_ + 250, [row](double x) { return StreetY(row, x); });
      const bool main = row == 0;
      scene_.roads.push_back({street, main ? 7.6 : 5.8, 2, 1.5, main});
      pieces_.AddLanes(street, main ? 1.9 : 1.5, main ? 120 : 190, main ? 11 : 7, main ? 15 : 10);
      pieces_.AddTreeRow(street, main ? 6.2 : 5.0, 23, 1.3, 2.6);
      // Some turn off into a cross street.
      const double corner = kWest + kBlock * (2 + random_.Below(3));
      std::vector<Vector2d> corners;
      for (double x = kWest - 250; x < corner - 12; x += 24)
        corners.emplace_back(x, StreetY(row, x));
      corners.emplace_back(corner, StreetY(row, corner));
      corners.emplace_back(corner, StreetY(kRows, corner) + 190);
      scene_.lanes.push_back({RoundedPath(corners, 9), 1.6, 400, 8, 12, {}, {}, {}});
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
  double east_;
};

}  // namespace

Scene BuildSuburb(const FlightPlan& plan) { return Suburb(plan).Build(); }

}  // namespace windhover::replay
