// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: a road along x through villages, fields to either side and woods beyond, as
// far as one sees.
constexpr double kWest = -100;
constexpr double kAhead = 2600;
constexpr double kReach = 900;
constexpr double kRoadWidth = 8.4;
constexpr double kVillage = 430;  // from village to village

class Valley {
 public:
  explicit Valley(const FlightPlan& plan)
      : pieces_(plan.seed, scene_),
        random_(Mix(plan.seed, 0x7A11E)),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + kAhead) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.3, 0.68, 0.72).normalized();
    scene_.meadow = {60, 112, 100};
    scene_.sky.haze_m = 5200;
  }

  Scene Build() {
    BuildFields();
    BuildRoads();
    for (double x = kWest + 190; x < east_; x += kVillage) BuildVillage(x);
    BuildWoods();
    return std::move(scene_);
  }

 private:
  static double RoadY(double x) { return 24 * Sine(x / 230) + 5 * Sine(x / 71 + 1); }

  void BuildFields() {
    for (double x = kWest; x < east_; x += 105) {
      for (double y = -kReach; y < kReach; y += 90) {
        if (random_.Chance(0.2)) continue;
        const Vector2d centre(x + random_.Uniform(-12, 12), y + random_.Uniform(-12, 12));
        const Vector2d forward = Vector2d(1, random_.Uniform(-0.35, 0.35)).normalized();
        const bool turned = random_.Chance(0.5);
        pieces_.AddField({centre, turned ? Right(forward) : forward, random_.Uniform(70, 110),
                          random_.Uniform(60, 95)});
        if (random_.Chance(0.3)) {
          scene_.hedges.push_back({{centre + 46 * Right(forward), forward, 84, 1.8}, 2.2});
        }
        if (random_.Chance(0.35)) {
          pieces_.AddTreeRow(Path({centre - 45 * forward, centre + 45 * forward}), 44, 9, 1.8, 4.2);
        }
      }
    }
  }

  void BuildRoads() {
    const Path road = LineAlongX(kWest - 300, east_, RoadY);
    scene_.roads.push_back({road, kRoadWidth, 2, 0, true});
    pieces_.AddLanes(road, 0.25 * kRoadWidth, 105, 14, 22);
    pieces_.AddTreeRow(road, 7.4, 31, 1.6, 3.2);
    for (double x = kWest + 190; x < east_; x += kVillage) {
      const Path cross({{x - 60, -kReach},
                        {x - 20, RoadY(x - 20) - 60},
                        {x, RoadY(x)},
                        {x + 10, RoadY(x) + 60},
                        {x + 70, kReach}});
      scene_.roads.push_back({cross, 6.2, 2, 1.2, false});
      pieces_.AddLanes(cross, 1.5, 190, 8, 14);
      scene_.junctions.push_back({{{x, RoadY(x)}, Vector2d::UnitX(), 9, 10}});
      // Out of the village onto the road.
      std::vector<Vector2d> corners = {{x + 10, RoadY(x) + 60}, {x, RoadY(x)}};
      for (double ahead = x + 24; ahead < x + 380; ahead += 24)
        corners.emplace_back(ahead, RoadY(ahead));
      scene_.lanes.push_back({RoundedPath(corners, 10), 2, 160, 12, 18, {}, {{52, 2.5, 0.8}}, {}});
    }
  }

  void BuildVillage(double x) {
    for (const double side : {-1.0, 1.0}) {
      for (double at = x - 118; at < x + 130; at += 19) {
        if (std::abs(at - x) < 16 || random_.Chance(0.15)) continue;
        const double from_road = random_.Uniform(19, 25);
        pieces_.AddHouse({at, RoadY(at) + side * from_road}, {0, -side}, 19);
        if (random_.Chance(0.55)) {
          pieces_.AddHouse({at + 4, RoadY(at) + side * (from_road + 46)}, {0, -side}, 19);
        }
        if (random_.Chance(0.3)) pieces_.AddParked({at + 6, RoadY(at) + side * 5.4}, {1, 0});
      }
    }
    pieces_.AddFarm({x + 178, RoadY(x + 178) + 62}, Vector2d(1, 0.2).normalized());
    // The church.
    const Vector2d church(x + 30, RoadY(x + 30) - 62);
    scene_.buildings.push_back({{church, Vector2d::UnitX(), 26, 11},
                                8,
                                6,
                                RoofKind::kGable,
                                {62, 72, 108},
                                {FacadeKind::kBlank, {150, 168, 180}}});
    scene_.buildings.push_back({{church - Vector2d(15, 0), Vector2d::UnitX(), 6.5, 6.5},
                                22,
                                9,
                                RoofKind::kHip,
                                {70, 74, 84},
                                {FacadeKind::kBlank, {150, 168, 180}}});
  }

  void BuildWoods() {
    for (double x = kWest; x < east_; x += 120) {
      for (const double side : {-1.0, 1.0}) {
        const double near = random_.Uniform(170, 420);
        const double length = random_.Uniform(70, 150);
        const double width = random_.Uniform(60, 150);
        pieces_.AddWood(
            {{x, side * near}, Vector2d(1, random_.Uniform(-0.5, 0.5)).normalized(), length, width},
            static_cast<int>(length * width / 30), 2.4, 4.8);
        pieces_.AddWood({{x, side * 820}, Vector2d::UnitX(), 150, 170}, 480, 3.2, 5.4);
      }
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
  double east_;
};

}  // namespace

Scene BuildValley(const FlightPlan& plan) { return Valley(plan).Build(); }

}  // namespace windhover::replay
