// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: one road along x near y = 0, fields of unequal size on both sides.
constexpr double kWest = -160;
constexpr double kAhead = 520;  // that the camera sees beyond the end of its flight
constexpr double kReach = 330;  // fields to either side of the road
constexpr double kRoadWidth = 6.4;

class Country {
 public:
  explicit Country(const FlightPlan& plan)
      : pieces_(plan.seed, scene_),
        random_(Mix(plan.seed, 0xC0127)),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + kAhead) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(0.52, 0.58, 0.8).normalized();
    scene_.meadow = {62, 112, 102};
  }

  Scene Build() {
    BuildFields();
    BuildRoad();
    BuildPoles();
    BuildFarms();
    BuildWoods();
    return std::move(scene_);
  }

 private:
  static double RoadY(double x) { return 9 * Sine(x / 120) + 3 * Sine(x / 47 + 2); }

  // Strips of fields across the road's direction, each cut a few times, with hedges between some.
  void BuildFields() {
    for (const double side : {-1.0, 1.0}) {
      for (double x = kWest; x < east_;) {
        const double length = random_.Uniform(45, 95);
        const double slant = random_.Uniform(-0.16, 0.16);
        const Vector2d away = Vector2d(slant, side).normalized();
        for (double from = random_.Uniform(7, 13); from < kReach;) {
          const double depth = random_.Uniform(38, 100);
          const Vector2d centre =
              Vector2d(x + 0.5 * length, RoadY(x + 0.5 * length)) + (from + 0.5 * depth) * away;
          AddField(centre, away, length - random_.Uniform(1, 4), depth - random_.Uniform(1, 4));
          from += depth;
        }
        x += length;
      }
    }
  }

  // With what grows round it: a strip of grass, a hedge on one side or two, trees in the hedge.
  void AddField(const Vector2d& centre, const Vector2d& away, double length, double depth) {
    const Vector2d along = Right(away);
    if (!random_.Chance(0.14)) {  // else pasture
      const bool along_road = random_.Chance(0.5);
      pieces_.AddField({centre, along_road ? along : away, along_road ? length : depth,
                        along_road ? depth : length});
      scene_.plots.push_back({{centre + 0.5 * length * along, away, depth, random_.Uniform(1.5, 4)},
                              GroundKind::kLawn,
                              {60, 112, 104}});
    } else {
      for (int i = 4 + random_.Below(9); i > 0; --i) {  // cattle's bushes
        pieces_.AddTree(centre + random_.Uniform(-0.45, 0.45) * length * along +
                            random_.Uniform(-0.45, 0.45) * depth * away,
                        random_.Uniform(0.5, 1.3));
      }
    }
    if (random_.Chance(0.55)) AddHedge(centre + 0.5 * length * along, away, depth - 6);
    if (random_.Chance(0.35)) AddHedge(centre + 0.5 * depth * away, along, length - 6);
    if (random_.Chance(0.25)) {  // a tree that was left standing
      pieces_.AddTree(centre + random_.Uniform(-0.3, 0.3) * depth * away +
                          random_.Uniform(-0.3, 0.3) * length * along,
                      random_.Uniform(2.6, 4.8));
    }
    if (random_.Chance(0.18)) AddBales(centre, away, along);
  }

  void AddHedge(const Vector2d& middle, const Vector2d& along, double length) {
    for (double at = -0.5 * length; at < 0.5 * length; at += 14) {
      if (random_.Chance(0.12)) continue;  // a gap
      scene_.hedges.push_back({{middle + (at + 7) * along, along, 14.5, random_.Uniform(1.1, 2.0)},
                               random_.Uniform(1.2, 2.3)});
      const int trees = random_.Below(4) - 1;
      for (int i = 0; i < trees; ++i) {
        pieces_.AddTree(middle + (at + random_.Uniform(0, 14)) * along, random_.Uniform(0.9, 3.8));
      }
    }
  }

  // Round bales of straw in rows, as a harvester leaves them.
  void AddBales(const Vector2d& centre, const Vector2d& away, const Vector2d& along) {
    for (int row = -2; row <= 2; ++row) {
      for (int i = -2; i <= 2; ++i) {
        if (random_.Chance(0.3)) continue;
        const Vector2d at = centre + (9.0 * row + random_.Uniform(-1, 1)) * along +
                            (11.0 * i + random_.Uniform(-3, 3)) * away;
        scene_.buildings.push_back(
            {{at, along, 1.5, 1.3}, 1.2, 0.15, RoofKind::kGable, {96, 152, 176}});
      }
    }
  }

  void BuildRoad() {
    const Path road = LineAlongX(kWest - 300, east_ + 200, RoadY);
    scene_.roads.push_back({road, kRoadWidth, 2, 0, true});
    scene_.lanes.push_back({road, 0.25 * kRoadWidth, 150, 18, 25, {}, {}, {}});
    scene_.lanes.push_back({road.Reversed(), 0.25 * kRoadWidth, 420, 16, 23, {}, {}, {}});
    BuildVerges(road);
    pieces_.AddTreeRow(road, 6.2, 8, 1.8, 3.4);
    pieces_.AddTreeRow(road, -6.8, 14, 1.4, 3.0);
    for (double x = kWest + random_.Uniform(40, 120); x < east_; x += random_.Uniform(140, 260)) {
      BuildTrack(x);
    }
  }

  // The ditch and the worn edge of the road.
  void BuildVerges(const Path& road) {
    for (double at = 0; at < road.length(); at += 6) {
      for (const double side : {-1.0, 1.0}) {
        const Path::Place place = road.At(at, side * (0.5 * kRoadWidth + 0.5));
        scene_.plots.push_back({{place.position, place.forward, 6.3, random_.Uniform(0.7, 1.5)},
                                GroundKind::kGravel,
                                {104, 126, 138}});
        if (random_.Chance(0.2)) {
          pieces_.AddTree(road.At(at, side * random_.Uniform(4.6, 6.6)).position,
                          random_.Uniform(0.4, 1.1));
        }
      }
    }
  }

  // A line of poles that comes along with the road and leaves it again.
  void BuildPoles() {
    for (double x = kWest; x < east_; x += 19) {
      const double y = RoadY(x) - 15 - 22 * Sine(x / 210);
      scene_.poles.push_back({{x, y}, 0.16, random_.Uniform(8, 9.5), {78, 92, 104}});
    }
  }

  // A way between the fields; now and then a tractor crosses the road on it.
  void BuildTrack(double x) {
    const double slant = random_.Uniform(-0.2, 0.2);
    const Path track({Vector2d(x - slant * kReach, RoadY(x) - kReach), Vector2d(x, RoadY(x)),
                      Vector2d(x + slant * kReach, RoadY(x) + kReach)});
    for (const std::size_t i : {0, 1}) {
      const Vector2d a = track.points()[i];
      const Vector2d b = track.points()[i + 1];
      scene_.plots.push_back({{0.5 * (a + b), (b - a).normalized(), (b - a).norm(), 3.4},
                              GroundKind::kGravel,
                              {112, 134, 150}});
    }
  }

  void BuildFarms() {
    for (double x = kWest + 130; x < east_; x += random_.Uniform(190, 330)) {
      const double side = random_.Chance(0.5) ? 1 : -1;
      const Vector2d centre(x, RoadY(x) + side * random_.Uniform(48, 85));
      pieces_.AddFarm(centre, Vector2d(1, random_.Uniform(-0.3, 0.3)).normalized());
      const Vector2d gate(x, RoadY(x));
      scene_.plots.push_back(
          {{0.5 * (centre + gate), (centre - gate).normalized(), (centre - gate).norm(), 3.6},
           GroundKind::kGravel,
           {116, 136, 150}});
    }
  }

  void BuildWoods() {
    for (double x = kWest; x < east_; x += random_.Uniform(110, 240)) {
      const double side = random_.Chance(0.5) ? 1 : -1;
      const double length = random_.Uniform(40, 110);
      const double width = random_.Uniform(30, 70);
      const Area area = {{x, side * random_.Uniform(120, 290)},
                         Vector2d(1, random_.Uniform(-0.4, 0.4)).normalized(),
                         length,
                         width};
      pieces_.AddWood(area, static_cast<int>(length * width / 22), 2.2, 4.2);
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
  double east_;
};

}  // namespace

Scene BuildCountry(const FlightPlan& plan) { return Country(plan).Build(); }

}  // namespace windhover::replay
