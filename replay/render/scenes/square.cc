// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/city.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: a paved square around (0, -44), where the hovering camera looks, with a
// fountain in its middle, cafes along its edges and old houses around it.
const Vector2d kMiddle(0, -44);
constexpr double kLong = 96;
constexpr double kWide = 70;

class Square {
 public:
  explicit Square(const FlightPlan& plan)
      : seed_(plan.seed), pieces_(plan.seed, scene_), city_(plan.seed, scene_, pieces_) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.7, 0.4, 0.95).normalized();
    scene_.meadow = {104, 112, 114};
    scene_.wind.sway_m = 0.2;
    scene_.glint = 0.06F;  // calm water
  }

  Scene Build() {
    scene_.plots.push_back({{kMiddle, Vector2d::UnitX(), kLong + 30, kWide + 30},
                            GroundKind::kSlabs,
                            {148, 158, 166},
                            0.8});
    scene_.plots.push_back(
        {{kMiddle, Vector2d::UnitX(), 34, 26}, GroundKind::kSlabs, {122, 130, 142}, 0.5});
    BuildFountain();
    BuildCafe(kMiddle + Vector2d(-27, -22), 7, 3, 1);
    BuildCafe(kMiddle + Vector2d(14, -24), 6, 3, 2);
    BuildCafe(kMiddle + Vector2d(20, 12), 5, 4, 3);
    BuildTrees();
    BuildFlag();
    BuildHouses();
    BuildWalks();
    return std::move(scene_);
  }

 private:
  Random RandomFor(std::uint64_t what) const { return Random(Mix(seed_, Mix(0x50A4E, what))); }

  void BuildFountain() {
    const Vector2d at = kMiddle + Vector2d(-3, -1);
    scene_.plots.push_back({{at, Vector2d::UnitX(), 11, 9}, GroundKind::kWater, {128, 112, 84}});
    for (const double side : {-1.0, 1.0}) {
      scene_.walls.push_back(
          {{at + Vector2d(0, side * 4.7), Vector2d::UnitX(), 12, 0.5}, 0.5, {170, 176, 182}});
      scene_.walls.push_back(
          {{at + Vector2d(side * 5.7, 0), Vector2d::UnitY(), 9.4, 0.5}, 0.5, {170, 176, 182}});
    }
    scene_.poles.push_back({at, 0.8, 1.4, {150, 156, 160}});
    scene_.poles.push_back({at, 0.3, 3.4, {96, 110, 104}});
  }

  // Tables under umbrellas, with chairs around them.
  void BuildCafe(const Vector2d& corner, int columns, int rows, std::uint64_t which) {
    static constexpr std::array<Colour, 4> kCloths = {
        {{206, 212, 214}, {74, 74, 168}, {92, 128, 176}, {104, 120, 84}}};
    Random random = RandomFor(0x100 + which);
    const Colour cloth = kCloths[random.Below(kCloths.size())];
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const Vector2d at = corner + Vector2d(3.1 * column + random.Uniform(-0.4, 0.4),
                                              3.0 * row + random.Uniform(-0.4, 0.4));
        if (random.Chance(0.72)) {
          scene_.canopies.push_back({{at, Vector2d::UnitX(), 2.6, 2.6}, 2.5, true, cloth});
        }
        scene_.walls.push_back(
            {{at + Vector2d(0.2, 0.5), Vector2d::UnitX(), 0.8, 0.8}, 0.74, {176, 182, 186}});
        for (int chair = 0; chair < 4; ++chair) {
          if (random.Chance(0.2)) continue;
          const double x = (chair % 2 == 0 ? -1.0 : 1.0) * random.Uniform(0.8, 1.1);
          const double y = (chair / 2 == 0 ? -0.35 : 0.45) + random.Uniform(-0.15, 0.15);
          scene_.walls.push_back(
              {{at + Vector2d(x, y + 0.4), Vector2d::UnitX(), 0.45, 0.45}, 0.8, {60, 84, 118}});
        }
      }
    }
    scene_.hedges.push_back(
        {{corner + Vector2d(1.5 * columns - 1.5, -2.2), Vector2d::UnitX(), 3.0 * columns, 0.6},
         0.9});
  }

  void BuildTrees() {
    Random random = RandomFor(0x200);
    for (int i = 0; i < 9; ++i) {
      pieces_.AddTree(kMiddle + Vector2d(-40 + 9.5 * i, 24 + random.Uniform(-0.8, 0.8)),
                      random.Uniform(1.8, 2.9));
      if (i != 4) {
        pieces_.AddTree(kMiddle + Vector2d(-41 + 9.8 * i, -29 + random.Uniform(-0.8, 0.8)),
                        random.Uniform(1.5, 2.6));
      }
    }
    for (int i = 0; i < 7; ++i) {
      Pole lamp;
      lamp.centre = kMiddle + Vector2d(-33 + 11 * i, i % 2 == 0 ? 16 : -15);
      lamp.height = 5.5;
      lamp.arm_m = 0.9;
      scene_.poles.push_back(lamp);
    }
    for (int i = 0; i < 12; ++i) {  // benches and bins
      const Vector2d at = kMiddle + Vector2d(random.Uniform(-36, 36), random.Uniform(-20, 22));
      scene_.walls.push_back({{at, random.Chance(0.5) ? Vector2d(1, 0) : Vector2d(0, 1), 1.9, 0.5},
                              0.5,
                              {70, 96, 128}});
    }
  }

  void BuildFlag() {
    Flag flag;
    flag.foot = kMiddle + Vector2d(9, -3);
    flag.height = 8.5;
    flag.bands = {{{104, 112, 132}, {96, 104, 150}, {104, 112, 132}}};
    flag.seed = 77;
    scene_.flags.push_back(flag);
  }

  void BuildHouses() {
    const double out_y = 0.5 * kWide + 24;
    const double out_x = 0.5 * kLong + 30;
    int index = 0;
    for (const double side : {-1.0, 1.0}) {
      city_.AddPerimeter({kMiddle + Vector2d(0, side * out_y), Vector2d::UnitX(), kLong, 44}, 11,
                         17, index++);
      city_.AddPerimeter({kMiddle + Vector2d(side * out_x, 0), Vector2d::UnitY(), kWide, 44}, 10,
                         16, index++);
    }
  }

  void AddWalk(const std::vector<Vector2d>& points, double width, int groups) {
    std::vector<Vector2d> path;
    for (const Vector2d& point : points) path.push_back(kMiddle + point);
    scene_.walks.push_back({RoundedPath(path, 4), width, groups, 0.5, 1.3});
  }

  void BuildWalks() {
    AddWalk({{-44, 9}, {-10, 7}, {14, 8}, {44, 12}}, 5, 7);
    AddWalk({{-44, -9}, {-14, -10}, {16, -12}, {44, -8}}, 5, 6);
    AddWalk({{-16, -30}, {-12, -8}, {-11, 10}, {-18, 30}}, 4, 5);
    AddWalk({{7, 30}, {7, 4}, {9, -10}, {4, -32}}, 4, 5);
    AddWalk({{-40, 26}, {-20, 16}, {10, 18}, {34, 26}}, 4, 4);
    AddWalk({{-38, -16}, {-8, -15}, {30, 6}, {42, 20}}, 4, 4);
  }

  Scene scene_;
  std::uint64_t seed_;
  Settlement pieces_;
  City city_;
};

}  // namespace

Scene BuildSquare(const FlightPlan& plan) { return Square(plan).Build(); }

}  // namespace windhover::replay
