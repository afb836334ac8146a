// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// A night seen by its warmth: all colours are grey levels of a thermal camera. The map, in metres:
// a quay along x with stacks of containers, sheds behind it, roads between, and water at negative
// y.
constexpr double kHalf = 360;  // of the square that is built on
constexpr double kQuayY = -120;
constexpr double kPitch = 118;  // between roads along y

Colour Grey(double level) {
  const auto value = static_cast<float>(level);
  return {value, value, value};
}

class Harbour {
 public:
  explicit Harbour(const FlightPlan& plan)
      : pieces_(plan.seed, scene_), random_(Mix(plan.seed, 0x4A2B)) {
    scene_.seed = plan.seed;
    scene_.thermal = true;
    scene_.glint = 0;
    // There is no sun: what is left of the slopes' shading stands for what the day has warmed.
    scene_.sun.direction = Eigen::Vector3d(-0.3, 0.35, 0.89).normalized();
    scene_.sun.ambient = 0.9F;
    scene_.meadow = Grey(78);
  }

  Scene Build() {
    BuildGround();
    BuildRoads();
    BuildSheds();
    BuildStacks();
    BuildParking();
    BuildTrees();
    for (Building& building : scene_.buildings) {
      building.facade = {FacadeKind::kBlank, Grey(building.colour[0] + random_.Uniform(2, 14))};
    }
    return std::move(scene_);
  }

 private:
  void BuildGround() {
    scene_.plots.push_back(
        {{{0, 60}, Vector2d::UnitX(), 2 * kHalf + 200, 360}, GroundKind::kPaved, Grey(98)});
    scene_.plots.push_back({{{0, kQuayY - 190}, Vector2d::UnitX(), 2 * kHalf + 400, 380},
                            GroundKind::kWater,
                            Grey(118)});  // water keeps the day's warmth
    scene_.plots.push_back(
        {{{0, kQuayY + 3}, Vector2d::UnitX(), 2 * kHalf + 200, 7}, GroundKind::kPaved, Grey(86)});
    for (int i = 0; i < 26; ++i) {
      const Vector2d at(random_.Uniform(-kHalf, kHalf), random_.Uniform(kQuayY + 10, 230));
      scene_.plots.push_back(
          {{at, Vector2d::UnitX(), random_.Uniform(12, 46), random_.Uniform(10, 34)},
           random_.Chance(0.5) ? GroundKind::kPaved : GroundKind::kGravel,
           Grey(random_.Uniform(82, 112))});
    }
  }

  void BuildRoads() {
    for (const double y : {kQuayY + 22, 8.0, 128.0}) {
      const Path road =
          LineAlongX(-kHalf - 150, kHalf + 150, [y](double x) { return y + 3 * Sine(x / 140); });
      scene_.roads.push_back({road, 8.5, 2, 0, true});
      pieces_.AddLanes(road, 2.1, 90, 7, 13);
    }
    for (double x = -2.5 * kPitch; x <= 2.6 * kPitch; x += kPitch) {
      const Path road({{x, kQuayY + 22}, {x + 4, 240}});
      scene_.roads.push_back({road, 7.5, 2, 0, false});
      pieces_.AddLanes(road, 1.9, 190, 6, 10);
      scene_.junctions.push_back({{{x + 1, 8 + 3 * Sine(x / 140)}, Vector2d::UnitX(), 9, 9}});
      scene_.junctions.push_back({{{x + 3, 128 + 3 * Sine(x / 140)}, Vector2d::UnitX(), 9, 9}});
      // From the quay into the yards.
      const double y = kQuayY + 22 + 3 * Sine(x / 140);
      scene_.lanes.push_back({RoundedPath({{x - 260, y}, {x, y}, {x + 4, 240}}, 12),
                              1.9,
                              260,
                              6,
                              10,
                              {},
                              {{235, 3, 0.5}},
                              {}});
    }
  }

  void BuildSheds() {
    for (double x = -2.5 * kPitch; x < 2.6 * kPitch; x += kPitch) {
      for (const double y : {68.0, 186.0}) {
        const Vector2d centre(x + 0.5 * kPitch + random_.Uniform(-4, 4),
                              y + random_.Uniform(-5, 5));
        scene_.buildings.push_back(
            {{centre, Vector2d::UnitX(), random_.Uniform(58, 84), random_.Uniform(30, 52)},
             random_.Uniform(7, 13),
             0.6,
             random_.Chance(0.6) ? RoofKind::kFlat : RoofKind::kGable,
             Grey(random_.Uniform(58, 104))});
        scene_.buildings.push_back({{centre + Vector2d(-46, random_.Uniform(-12, 12)),
                                     Vector2d::UnitY(), random_.Uniform(9, 16), 8},
                                    random_.Uniform(4, 6),
                                    0.4,
                                    RoofKind::kFlat,
                                    Grey(random_.Uniform(80, 122))});
      }
    }
  }

  // Rows of containers, up to four high, and two cranes over them.
  void BuildStacks() {
    for (double x = -kHalf; x < kHalf; x += 14.2) {
      const double on_road = std::abs(std::remainder(x + 7 - 0.5 * kPitch, kPitch));
      if (on_road < 14) continue;
      for (double y = kQuayY + 34; y < -12; y += 2.9) {
        const bool aisle = static_cast<int>(std::floor((y - kQuayY) / 2.9)) % 7 == 0;
        if (aisle || random_.Chance(0.3)) continue;
        const int high = 1 + random_.Below(4);
        scene_.buildings.push_back({{{x, y}, Vector2d::UnitX(), 12.2, 2.5},
                                    2.6 * high - 0.05,
                                    0.05,
                                    RoofKind::kFlat,
                                    Grey(random_.Uniform(70, 108))});
      }
    }
    for (const double x : {-130.0, 40.0, 190.0}) {
      for (const double y : {kQuayY + 6, kQuayY + 15}) {
        scene_.buildings.push_back(
            {{{x, y}, Vector2d::UnitX(), 16, 1.6}, 24, 0.3, RoofKind::kFlat, Grey(112)});
      }
      scene_.buildings.push_back(
          {{{x, kQuayY - 8}, Vector2d::UnitY(), 58, 3}, 30, 0.3, RoofKind::kFlat, Grey(106)});
    }
    // A ship at the quay.
    scene_.buildings.push_back(
        {{{-60, kQuayY - 17}, Vector2d::UnitX(), 128, 21}, 6, 0.8, RoofKind::kFlat, Grey(92)});
    scene_.buildings.push_back(
        {{{-112, kQuayY - 17}, Vector2d::UnitX(), 14, 18}, 17, 0.6, RoofKind::kFlat, Grey(112)});
  }

  void BuildParking() {
    pieces_.AddParking({-90, 142}, 1, 26, 0.6);
    pieces_.AddParking({60, 20}, 1, 15, 0.5);
    for (int i = 0; i < 70; ++i) {
      const double x = random_.Uniform(-kHalf, kHalf);
      pieces_.AddParked({x, (random_.Chance(0.5) ? 16.0 : 120.0) + 3 * Sine(x / 140)}, {1, 0});
    }
    // They have stood for long and are about as cold as the ground; a few have just come.
    for (ParkedVehicle& parked : scene_.parked) {
      parked.look = ThermalLook(parked.look, random_.Chance(0.12) ? 0.9 : 0.1, random_);
    }
  }

  void BuildTrees() {
    for (int i = 0; i < 160; ++i) {
      const double y = random_.Chance(0.6) ? random_.Uniform(136, 142) : random_.Uniform(228, 330);
      pieces_.AddTree({random_.Uniform(-kHalf, kHalf), y}, random_.Uniform(1.4, 3.6),
                      Grey(random_.Uniform(96, 118)));
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
};

}  // namespace

Scene BuildHarbour(const FlightPlan& plan) { return Harbour(plan).Build(); }

}  // namespace windhover::replay
