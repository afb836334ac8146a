// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/city.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: avenues along x, streets along y, and towers on most of the blocks between.
constexpr double kWest = -240;
constexpr double kStreet = 84;   // from street to street
constexpr double kAvenue = 74;   // from avenue to avenue
constexpr double kSouth = -259;  // the first avenue
constexpr int kAvenues = 8;

class Towers {
 public:
  explicit Towers(const FlightPlan& plan)
      : seed_(plan.seed),
        pieces_(plan.seed, scene_),
        city_(plan.seed, scene_, pieces_),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 240) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.5, 0.35, 1.05).normalized();
    scene_.sun.ambient = 0.8F;
    scene_.meadow = {84, 108, 104};
  }

  Scene Build() {
    StreetGrid grid;
    for (int i = 0; i < kAvenues; ++i) grid.along_x.push_back(kSouth + i * kAvenue);
    for (double x = kWest; x < east_; x += kStreet) grid.along_y.push_back(x);
    grid.low_x = kWest - 60;
    grid.high_x = east_ + 60;
    grid.low_y = kSouth - 60;
    grid.high_y = kSouth + (kAvenues - 1) * kAvenue + 60;
    grid.width_x = 14;
    grid.lanes_x = 4;
    grid.width_y = 10;
    grid.pavement = 3.5;
    grid.spacing_x = 34;
    grid.spacing_y = 38;
    grid.speed_low = 8;
    grid.speed_high = 14;
    AddStreets(grid, seed_, scene_, pieces_);
    int index = 0;
    for (int i = 0; i + 1 < kAvenues; ++i) {
      const double y = kSouth + (i + 0.5) * kAvenue;
      for (const double x : grid.along_y) BuildBlock({x + 0.5 * kStreet, y}, index++);
    }
    for (const double y : grid.along_x) {
      const Path street({{grid.low_x, y}, {grid.high_x, y}});
      city_.AddLamps(street, 8.6, 28);
      city_.AddClutter(street, -9.4, index++);
      pieces_.AddTreeRow(street, 9.8, 17, 1.3, 2.3);
    }
    return std::move(scene_);
  }

 private:
  void BuildBlock(const Vector2d& centre, int index) {
    Random random(Mix(seed_, Mix(0x70E25, static_cast<std::uint64_t>(index))));
    const Area block = {centre, Vector2d::UnitX(), kStreet - 18, kAvenue - 22};
    const double pick = random.Uniform();
    if (pick < 0.66) {
      city_.AddTowers(block, 30, 74, index);
    } else if (pick < 0.86) {
      city_.AddPerimeter(block, 18, 27, index);
    } else if (pick < 0.94) {
      city_.AddPark(block, index);
    } else {
      pieces_.AddParking(centre - Vector2d(26, 20), 2, 20, 0.7);
    }
  }

  Scene scene_;
  std::uint64_t seed_;
  Settlement pieces_;
  City city_;
  double east_;
};

}  // namespace

Scene BuildTowers(const FlightPlan& plan) { return Towers(plan).Build(); }

}  // namespace windhover::replay
