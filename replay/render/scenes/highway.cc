// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: two carriageways along x on either side of a planted strip, a service road
// with parked trucks beside them, fields and works beyond.
constexpr double kWest = -150;
constexpr double kCarriageway = 11.0;
constexpr double kToMiddle = 8.0;  // of a carriageway from the middle of the strip
constexpr double kServiceY = 34.0;

class Highway {
 public:
  explicit Highway(const FlightPlan& plan)
      : pieces_(plan.seed, scene_),
        random_(Mix(plan.seed, 0x419A)),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 220) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.45, -0.6, 0.75).normalized();
    scene_.meadow = {58, 108, 98};
  }

  Scene Build() {
    scene_.wind.sway_m = 0.05;
    BuildLand();
    BuildRoads();
    BuildVerges();
    BuildFurniture();
    BuildWorks();
    return std::move(scene_);
  }

 private:
  static double MiddleY(double x) { return 7 * Sine(x / 160); }

  Path Beside(double y) const {
    return LineAlongX(kWest - 500, east_ + 500, [y](double x) { return MiddleY(x) + y; });
  }

  void BuildLand() {
    for (const double side : {-1.0, 1.0}) {
      for (double x = kWest; x < east_; x += 75) {
        pieces_.AddField({{x + 35, side * random_.Uniform(88, 96) + MiddleY(x)},
                          Vector2d(1, random_.Uniform(-0.05, 0.05)).normalized(),
                          72,
                          84});
      }
    }
  }

  void BuildRoads() {
    scene_.roads.push_back({Beside(-kToMiddle), kCarriageway, 2, 0, true});
    scene_.roads.push_back({Beside(kToMiddle), kCarriageway, 2, 0, true});
    const Path east = Beside(kToMiddle);
    const Path west = Beside(-kToMiddle).Reversed();
    for (const double right : {-2.6, 2.6}) {
      const double speed = right < 0 ? 30 : 24;
      scene_.lanes.push_back({east, right, 120, speed - 2, speed + 5, {}, {}, {}});
      scene_.lanes.push_back({west, right, 240, speed - 2, speed + 5, {}, {}, {}});
    }
    const Path service = Beside(kServiceY);
    scene_.roads.push_back({service, 6.2, 2, 1.2, false});
    pieces_.AddLanes(service, 1.5, 210, 9, 13);
    for (double x = kWest; x < east_; x += random_.Uniform(11, 60)) {
      pieces_.AddParked({x, MiddleY(x) + kServiceY + 4.6}, {1, 0});
    }
  }

  // What grows between and beside the roads, and the barriers.
  void BuildVerges() {
    const Path middle = Beside(0);
    for (double at = 0; at < middle.length(); at += 4) {
      const Path::Place place = middle.At(at);
      scene_.hedges.push_back({{place.position, place.forward, 4.2, 0.5}, 0.9});
      scene_.hedges.push_back(
          {{place.position + 15 * Right(place.forward), place.forward, 4.2, 0.4}, 0.8});
    }
    for (double at = 0; at < middle.length(); at += random_.Uniform(6, 22)) {
      const double side = random_.Chance(0.35)  ? random_.Uniform(-1, 1)
                          : random_.Chance(0.5) ? random_.Uniform(17, 29)
                                                : random_.Uniform(-40, -16);
      const bool low = std::abs(side) < 2;
      pieces_.AddTree(middle.At(at, side).position,
                      low ? random_.Uniform(0.4, 0.8) : random_.Uniform(0.5, 1.5));
    }
    pieces_.AddTreeRow(middle, -22, 34, 1.2, 2.2);
  }

  // Rails along the carriageways, signs and lamps.
  void BuildFurniture() {
    for (const double side : {-1.9, 1.9, 14.2, -14.2}) {
      const Path rail = Beside(side);
      for (double at = 0; at < rail.length(); at += 8) {
        const Path::Place place = rail.At(at);
        scene_.walls.push_back({{place.position, place.forward, 8.1, 0.28}, 0.75, {176, 178, 178}});
      }
    }
    for (double x = kWest; x < east_; x += 84) {
      scene_.poles.push_back({{x, MiddleY(x)}, 0.12, 7, {112, 114, 114}, 1.8, {0, 1}});
      const double at = x + random_.Uniform(0, 30);
      scene_.poles.push_back(
          {{at, MiddleY(at) + 16.5}, 0.07, random_.Uniform(1.5, 2.5), {140, 142, 140}});
    }
    for (double x = kWest + 60; x < east_; x += random_.Uniform(130, 210)) {  // sign boards
      scene_.walls.push_back(
          {{{x, MiddleY(x) - 16.5}, Vector2d::UnitY(), 4.5, 0.25}, 5.5, {168, 110, 52}});
    }
  }

  void BuildWorks() {
    for (double x = kWest + 40; x < east_; x += random_.Uniform(85, 130)) {
      const Vector2d centre(x, MiddleY(x) + 66);
      scene_.plots.push_back(
          {{centre, Vector2d::UnitX(), 70, 48}, GroundKind::kPaved, {112, 114, 114}});
      scene_.buildings.push_back(
          {{centre + Vector2d(0, 6), Vector2d::UnitX(), random_.Uniform(28, 42), 20},
           random_.Uniform(6, 9),
           0.6,
           RoofKind::kFlat,
           {140, 142, 142}});
      for (int i = 0; i < 8; ++i) {
        if (random_.Chance(0.7)) pieces_.AddParked(centre + Vector2d(-20 + 5.0 * i, -14), {0, 1});
      }
    }
    for (double x = kWest; x < east_; x += random_.Uniform(26, 60)) {
      pieces_.AddHouse({x, MiddleY(x) - 62}, {0, 1}, 22);
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
  double east_;
};

}  // namespace

Scene BuildHighway(const FlightPlan& plan) { return Highway(plan).Build(); }

}  // namespace windhover::replay
