// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: the main road runs along x near y = 0, residential streets lie at negative y,
// commerce and fields at positive y.
constexpr double kWest = -420;
constexpr double kBlock = 118;  // between two crossing streets
constexpr double kLane = 3.4;
constexpr double kMainWidth = 14.4;
constexpr double kStreetWidth = 6.6;
constexpr double kSideStreetY = -58;
constexpr double kReach = 190;  // how far crossing streets go from the main road
constexpr double kPeriod = 13;  // of the lights, s
constexpr double kCrossGreen = 4.5;
constexpr double kStopDistance = 9;  // of the stop lines before the middle of a junction

class Outskirts {
 public:
  explicit Outskirts(const FlightPlan& plan)
      : pieces_(plan.seed, scene_),
        random_(Mix(plan.seed, 0x5CE7E)),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 420) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.62, 0.48, 0.86).normalized();
    scene_.meadow = {64, 104, 96};
  }

  Scene Build() {
    BuildRoads();
    for (std::size_t i = 0; i + 1 < crossings_.size(); ++i) {
      BuildResidentialBlock(crossings_[i], crossings_[i + 1]);
      if (i % 2 == 0) {
        BuildCommerce(crossings_[i], crossings_[i + 1]);
      } else {
        BuildSmallPlots(crossings_[i], crossings_[i + 1]);
      }
    }
    BuildFields();
    BuildStreetTrees();
    return std::move(scene_);
  }

 private:
  static double MainY(double x) { return 5 * Sine(x / 85) + 2 * Sine(x / 31 + 1); }

  void BuildRoads() {
    const Path main = LineAlongX(kWest, east_, MainY);
    for (double x = kWest + 70 + random_.Uniform(0, 20); x < east_ - 60;
         x += kBlock + random_.Uniform(-8, 8)) {
      crossings_.push_back(x);
    }
    std::vector<Lane::Light> main_lights;
    for (const double x : crossings_) {
      const double shift = random_.Uniform(0, kPeriod);
      main_lights.push_back({AlongMain(main, x) - kStopDistance, kPeriod, shift + kCrossGreen + 1,
                             kPeriod - kCrossGreen - 2});
      BuildCrossing(x, shift);
    }
    scene_.roads.push_back({main, kMainWidth, 4, 2.2, true});
    for (const double lateral : {0.55 * kLane, 1.6 * kLane}) {
      pieces_.AddLanes(main, lateral, 70, 9.5, 16.5, main_lights, kStopDistance);
    }
    const Path side =
        LineAlongX(kWest, east_, [](double x) { return kSideStreetY + 3 * Sine(x / 40); });
    scene_.roads.push_back({side, 5.6, 2, 1.4, false});
    pieces_.AddLanes(side, 1.4, 95, 6.0, 8.5);
  }

  static double AlongMain(const Path& main, double x) {
    const auto i = static_cast<std::size_t>((x - main.points().front().x()) / 4);
    return main.at(i) + (x - main.points()[i].x());
  }

  void BuildCrossing(double x, double shift) {
    const double slant = random_.Uniform(-0.12, 0.12);
    std::vector<Vector2d> points;
    for (double y = -kReach; y <= kReach; y += 4) points.emplace_back(x + slant * y, MainY(x) + y);
    const Path path(points);
    scene_.roads.push_back({path, kStreetWidth, 2, 1.6, true});
    const double stop = 0.5 * path.length() - kStopDistance;
    pieces_.AddLanes(path, 1.6, 70, 7.0, 10.5, {{stop, kPeriod, shift, kCrossGreen}},
                     kStopDistance);
    scene_.junctions.push_back(
        {{{x, MainY(x)}, path.At(0.5 * path.length()).forward, kMainWidth + 1, kStreetWidth + 1}});
    scene_.junctions.push_back(
        {{{x + slant * kSideStreetY, kSideStreetY + MainY(x)}, Vector2d::UnitX(), 9, 12}});
  }

  void BuildResidentialBlock(double from, double to) {
    const double lot = 17;
    for (double x = from + 20; x < to - 14; x += lot) {
      const double y = kSideStreetY + 3 * Sine(x / 40);
      if (!random_.Chance(0.08)) {
        pieces_.AddHouse({x, y + 17 + random_.Uniform(-1, 1)}, {0, -1}, lot);
      }
      if (!random_.Chance(0.08)) {
        pieces_.AddHouse({x, y - 17 + random_.Uniform(-1, 1)}, {0, 1}, lot);
      }
      if (random_.Chance(0.5)) {
        pieces_.AddParked({x + random_.Uniform(-5, 5), y + (random_.Chance(0.5) ? 3.7 : -3.7)},
                          {1, 0});
      }
      pieces_.AddHouse({x, y - 62 + random_.Uniform(-2, 2)}, {0, -1}, lot);
    }
    scene_.hedges.push_back(
        {{{0.5 * (from + to), -13}, Vector2d::UnitX(), to - from - 30, 1.1}, 1.6});
    // The green between the gardens and the main road.
    for (int i = 0; i < 9; ++i) {
      pieces_.AddTree({random_.Uniform(from + 16, to - 16), random_.Uniform(-30, -17)},
                      random_.Uniform(0.5, 3.2));
    }
    scene_.plots.push_back(
        {{{0.5 * (from + to), -15.5}, Vector2d(1, 0.03).normalized(), to - from - 26, 1.6},
         GroundKind::kGravel,
         {138, 150, 158}});
  }

  void BuildCommerce(double from, double to) {
    const double middle = 0.5 * (from + to);
    pieces_.AddParking({from + 22, 17}, 2, 24, 0.58);
    scene_.buildings.push_back({{{middle + 4, 74}, Vector2d::UnitX(), 62, 26},
                                random_.Uniform(6.5, 8.5),
                                0.6,
                                RoofKind::kFlat,
                                {150, 152, 152}});
    scene_.buildings.push_back({{{to - 17, 36}, Vector2d::UnitY(), 18, 12},
                                random_.Uniform(4, 6),
                                0.5,
                                RoofKind::kFlat,
                                {118, 122, 128}});
    scene_.plots.push_back(
        {{{middle + 4, 97}, Vector2d::UnitX(), 80, 14}, GroundKind::kPaved, {120, 121, 121}});
    for (int i = 0; i < 6; ++i)
      pieces_.AddTree({from + 24 + 12.0 * i, 58 + random_.Uniform(-1, 1)}, 1.9);
  }

  void BuildSmallPlots(double from, double to) {
    for (double x = from + 18; x < to - 12; x += 20) {
      if (random_.Chance(0.5)) {
        pieces_.AddHouse({x, 30 + random_.Uniform(-2, 2)}, {0, -1}, 19);
      } else {
        pieces_.AddGarden({x, 28}, {1, 0}, 18);
        pieces_.AddTree({x + random_.Uniform(-5, 5), 38}, random_.Uniform(2, 3.6));
      }
    }
    for (int i = 0; i < 60; ++i) {  // a small wood
      pieces_.AddTree({random_.Uniform(from + 14, to - 50), random_.Uniform(54, 100)},
                      random_.Uniform(2.0, 4.2));
    }
    scene_.plots.push_back(
        {{{to - 26, 80}, Vector2d::UnitX(), 36, 44}, GroundKind::kGravel, {120, 142, 156}});
    for (int i = 0; i < 8; ++i) {
      pieces_.AddParked({to - 38 + 3.2 * i, 66 + random_.Uniform(-1, 1)}, {0, 1});
    }
  }

  void BuildFields() {
    for (double x = kWest; x < east_; x += 64) {
      pieces_.AddField({{x, 150}, Vector2d(0.12, 1).normalized(), 92, 62});
      pieces_.AddField({{x, -178}, Vector2d(1, 0.2).normalized(), 70, 60});
    }
  }

  void BuildStreetTrees() {
    for (double x = kWest; x < east_; x += random_.Uniform(11, 19)) {
      const auto near = [x](double crossing) { return std::abs(crossing - x) < 14; };
      if (std::any_of(crossings_.begin(), crossings_.end(), near)) continue;
      pieces_.AddTree({x, MainY(x) - 11.2}, random_.Uniform(1.4, 2.5));
      if (random_.Chance(0.55))
        pieces_.AddTree({x + 4, MainY(x) + 11.4}, random_.Uniform(1.3, 2.3));
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
  double east_;
  std::vector<double> crossings_;
};

}  // namespace

Scene BuildOutskirts(const FlightPlan& plan) { return Outskirts(plan).Build(); }

}  // namespace windhover::replay
