// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>
#include <vector>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/city.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: a motorway along x, another that crosses it on a bridge at kCross, ramps
// between them, and a service road on either side.
constexpr double kWest = -320;
constexpr double kCross = 70;
constexpr double kLane = 3.5;
constexpr double kMotorway = 26;   // width of the one below
constexpr double kOver = 17;       // of the one on the bridge
constexpr double kDeck = 6.8;      // m over the lower road
constexpr double kService = 44;    // distance of the service roads
constexpr double kRampDeck = 5.4;  // m over them
constexpr double kReach = 330;     // of the crossing road

class Interchange {
 public:
  explicit Interchange(const FlightPlan& plan)
      : seed_(plan.seed),
        pieces_(plan.seed, scene_),
        city_(plan.seed, scene_, pieces_),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 320) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.55, 0.5, 0.9).normalized();
    scene_.meadow = {66, 112, 100};
  }

  Scene Build() {
    BuildLower();
    BuildUpper();
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) BuildRamp(x, y);
    }
    BuildSides();
    return std::move(scene_);
  }

 private:
  void AddLane(const Path& path, double right, double spacing, double low, double high,
               const std::vector<HeightKnot>& knots = {}) {
    scene_.lanes.push_back({path, right, spacing, low, high, {}, {}, knots});
  }

  void BuildLower() {
    const Path path({{kWest, 0}, {east_, 0}});
    scene_.roads.push_back({path, kMotorway, 6, 0.6, true});
    scene_.walls.push_back(
        {{{0.5 * (kWest + east_), 0}, Vector2d::UnitX(), east_ - kWest, 0.5}, 0.9});
    for (int i = 0; i < 3; ++i) {
      const double right = 2.6 + kLane * i;
      const double slow = 16 - 2.5 * i;
      AddLane(path, right, 34 + 4 * i, slow, slow + 7);
      AddLane(path.Reversed(), right, 34 + 4 * i, slow, slow + 7);
    }
    for (const double y : {-kService, kService}) {
      const Path service({{kWest, y}, {east_, y}});
      scene_.roads.push_back({service, 7, 2, 1.2, true});
      pieces_.AddLanes(service, 1.75, 48, 8, 13);
      city_.AddLamps(service, y > 0 ? 5.2 : -5.2, 30);
    }
    city_.AddLamps(path, 14.5, 36);
    city_.AddLamps(path, -14.5, 36);
  }

  void BuildUpper() {
    const Path path({{kCross, -kReach}, {kCross, -110}, {kCross, 110}, {kCross, kReach}});
    scene_.roads.push_back({path, kOver - 0.8, 4, 0.6, true});
    const double middle = kReach;
    const std::vector<HeightKnot> knots = {
        {middle - 190, 0}, {middle - 66, kDeck}, {middle + 66, kDeck}, {middle + 190, 0}};
    scene_.bridges.push_back({path, kOver, 3.6, knots, middle - 52, middle + 52});
    for (int i = 0; i < 2; ++i) {
      const double right = 1.9 + 3.6 * i;
      AddLane(path, right, 36, 13, 20, knots);
      AddLane(path.Reversed(), right, 36, 13, 20, knots);
    }
  }

  // From the lower road to the upper one, outside of the corner towards (x, y).
  void BuildRamp(double x, double y) {
    const Path path = RoundedPath({{kCross + x * 230, y * 15.6},
                                   {kCross + x * 120, y * 19},
                                   {kCross + x * 34, y * 64},
                                   {kCross + x * 13.2, y * 165},
                                   {kCross + x * 11.2, y * 260}},
                                  26);
    const double length = path.length();
    const double over = WayTo(path, y * kService);
    const std::vector<HeightKnot> knots = {{over - 70, 0},
                                           {over - 14, kRampDeck},
                                           {over + 14, kRampDeck},
                                           {std::min(over + 95, length - 4), 0}};
    scene_.roads.push_back({path, 5.4, 2, 0.6, false});
    scene_.bridges.push_back({path, 6.4, 9, knots, over - 13, over + 13});
    // Traffic keeps to the right: two of the ramps lead up, two down.
    AddLane(x * y < 0 ? path : path.Reversed(), 0, 40, 11, 16,
            x * y < 0 ? knots : Mirrored(knots, length));
  }

  // How far along a path the line at height y of the map is met.
  static double WayTo(const Path& path, double y) {
    double at = 0;
    while (at < path.length() &&
           (path.At(at).position.y() - y) * (path.At(0).position.y() - y) > 0) {
      at += 0.5;
    }
    return at;
  }

  static std::vector<HeightKnot> Mirrored(const std::vector<HeightKnot>& knots, double length) {
    std::vector<HeightKnot> back;
    for (auto knot = knots.rbegin(); knot != knots.rend(); ++knot) {
      back.push_back({length - knot->at_m, knot->height_m});
    }
    return back;
  }

  void BuildSides() {
    Random random(Mix(seed_, 0x1C4A));
    for (double x = kWest + 40; x < east_ - 40; x += 74) {
      const bool near = x > kCross - 80 && x < kCross + 80;
      for (const double side : {-1.0, 1.0}) {
        const double pick = random.Uniform();
        const Vector2d centre(x, side * 86);
        if (near) continue;
        if (pick < 0.4) {
          scene_.buildings.push_back({{centre, Vector2d::UnitX(), 54, 34},
                                      random.Uniform(7, 12),
                                      0.8,
                                      RoofKind::kFlat,
                                      {146, 150, 152},
                                      {FacadeKind::kBands, {170, 172, 176}}});
          for (int i = 0; i < 17; ++i) {
            if (random.Chance(0.6)) {
              pieces_.AddParked({x - 24 + 2.9 * i, side * 60.0}, {0, 1});
            }
          }
        } else if (pick < 0.7) {
          pieces_.AddParking({x - 30, side > 0 ? 60.0 : -108.0}, 3, 22, 0.7);
        } else {
          pieces_.AddWood({centre, Vector2d::UnitX(), 64, 44}, 60, 1.8, 4.2);
        }
      }
    }
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        pieces_.AddWood({{kCross + x * 62, y * 86}, Vector2d::UnitX(), 44, 48}, 26, 1.2, 3.2);
      }
    }
  }

  Scene scene_;
  std::uint64_t seed_;
  Settlement pieces_;
  City city_;
  double east_;
};

}  // namespace

Scene BuildInterchange(const FlightPlan& plan) { return Interchange(plan).Build(); }

}  // namespace windhover::replay
