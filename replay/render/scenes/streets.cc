// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/city.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: narrow streets between blocks of old houses, with cars along every kerb.
constexpr double kWest = -300;
constexpr double kStreet = 96;
constexpr double kLane = 66;
constexpr double kSouth = -297;
constexpr int kLanes = 10;
constexpr double kWidth = 6.6;     // of the carriageway between the parked rows
constexpr double kParkedAt = 4.4;  // from the middle of the street

class Streets {
 public:
  explicit Streets(const FlightPlan& plan)
      : seed_(plan.seed),
        pieces_(plan.seed, scene_),
        city_(plan.seed, scene_, pieces_),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 300) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(-0.42, 0.62, 0.9).normalized();
    scene_.meadow = {92, 108, 108};
  }

  Scene Build() {
    StreetGrid grid;
    for (int i = 0; i < kLanes; ++i) grid.along_x.push_back(kSouth + i * kLane);
    for (double x = kWest; x < east_; x += kStreet) grid.along_y.push_back(x);
    grid.low_x = kWest - 60;
    grid.high_x = east_ + 60;
    grid.low_y = kSouth - 60;
    grid.high_y = kSouth + (kLanes - 1) * kLane + 60;
    // The carriageway is as wide as the lanes and the parked rows need together.
    grid.width_x = kWidth + 4.4;
    grid.width_y = kWidth + 4.4;
    grid.pavement = 2.6;
    grid.spacing_x = 62;
    grid.spacing_y = 70;
    grid.speed_low = 6;
    grid.speed_high = 12;
    AddStreets(grid, seed_, scene_, pieces_);
    // Lanes keep to the middle, between the rows.
    for (Lane& lane : scene_.lanes) lane.right_m = 1.55;
    BuildRows(grid);
    int index = 0;
    for (int i = 0; i + 1 < kLanes; ++i) {
      for (const double x : grid.along_y) {
        BuildBlock({x + 0.5 * kStreet, kSouth + (i + 0.5) * kLane}, index++);
      }
    }
    return std::move(scene_);
  }

 private:
  void BuildRows(const StreetGrid& grid) {
    int index = 0;
    for (const double y : grid.along_x) {
      for (const double x : grid.along_y) {
        const Path along({{x + 16, y}, {x + kStreet - 16, y}});
        city_.AddParkedRows(along, kParkedAt, 0.78, index++);
        city_.AddLamps(along, 6.4, 32);
        city_.AddClutter(along, -7.2, index);
        pieces_.AddTreeRow(along, -7.0, 19, 1.2, 2.2);
        const Path across({{x, y + 16}, {x, y + kLane - 16}});
        city_.AddParkedRows(across, kParkedAt, 0.72, index++);
        pieces_.AddTreeRow(across, 7.0, 17, 1.1, 2.0);
      }
    }
  }

  void BuildBlock(const Vector2d& centre, int index) {
    Random random(Mix(seed_, Mix(0x57EE7, static_cast<std::uint64_t>(index))));
    const Area block = {centre, Vector2d::UnitX(), kStreet - 18, kLane - 18};
    const double pick = random.Uniform();
    if (pick < 0.78) {
      city_.AddPerimeter(block, 10, 17, index);
    } else if (pick < 0.88) {
      city_.AddPark(block, index);
    } else {
      pieces_.AddParking(centre - Vector2d(32, 17), 2, 24, 0.75);
    }
  }

  Scene scene_;
  std::uint64_t seed_;
  Settlement pieces_;
  City city_;
  double east_;
};

}  // namespace

Scene BuildStreets(const FlightPlan& plan) { return Streets(plan).Build(); }

}  // namespace windhover::replay
