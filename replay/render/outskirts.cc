// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"

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

class Outskirts {
 public:
  explicit Outskirts(const FlightPlan& plan)
      : random_(Mix(plan.seed, 0x5CE7E)),
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

  static Path Line(double x0, double x1, double (*y)(double)) {
    std::vector<Vector2d> points;
    for (double x = x0; x <= x1 + 1e-9; x += 4) points.emplace_back(x, y(x));
    return Path(std::move(points));
  }

  void AddStreetLanes(const Path& path, double lateral, double spacing, double low, double high,
                      const std::vector<Lane::Light>& lights) {
    scene_.lanes.push_back({path, lateral, spacing, low, high, lights});
    std::vector<Lane::Light> back;
    for (auto light = lights.rbegin(); light != lights.rend(); ++light) {
      back.push_back(*light);
      // The stop line lies on the near side of the junction, seen from the other end.
      back.back().at_m = path.length() - light->at_m - 2 * stop_distance_;
    }
    scene_.lanes.push_back({path.Reversed(), lateral, spacing, low, high, back});
  }

  void BuildRoads() {
    const Path main = Line(kWest, east_, MainY);
    for (double x = kWest + 70 + random_.Uniform(0, 20); x < east_ - 60;
         x += kBlock + random_.Uniform(-8, 8)) {
      crossings_.push_back(x);
    }
    std::vector<Lane::Light> main_lights;
    stop_distance_ = 9;
    for (const double x : crossings_) {
      const double shift = random_.Uniform(0, kPeriod);
      main_lights.push_back({AlongMain(main, x) - stop_distance_, kPeriod, shift + kCrossGreen + 1,
                             kPeriod - kCrossGreen - 2});
      BuildCrossing(x, shift);
    }
    scene_.roads.push_back({main, kMainWidth, 4, 2.2, true});
    for (const double lateral : {0.55 * kLane, 1.6 * kLane}) {
      AddStreetLanes(main, lateral, 70, 9.5, 16.5, main_lights);
    }
    const Path side = Line(kWest, east_, [](double x) { return kSideStreetY + 3 * Sine(x / 40); });
    scene_.roads.push_back({side, 5.6, 2, 1.4, false});
    AddStreetLanes(side, 1.4, 95, 6.0, 8.5, {});
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
    const double stop = 0.5 * path.length() - stop_distance_;
    AddStreetLanes(path, 1.6, 70, 7.0, 10.5, {{stop, kPeriod, shift, kCrossGreen}});
    scene_.junctions.push_back(
        {{{x, MainY(x)}, path.At(0.5 * path.length()).forward, kMainWidth + 1, kStreetWidth + 1}});
    scene_.junctions.push_back(
        {{{x + slant * kSideStreetY, kSideStreetY + MainY(x)}, Vector2d::UnitX(), 9, 12}});
  }

  Colour RoofColour() {
    static constexpr std::array<Colour, 6> kRoofs = {{{62, 76, 142},
                                                      {70, 84, 122},
                                                      {84, 84, 88},
                                                      {60, 62, 70},
                                                      {92, 112, 150},
                                                      {110, 116, 122}}};
    Colour colour = kRoofs[random_.Below(kRoofs.size())];
    const auto shift = static_cast<float>(random_.Uniform(-9, 9));
    for (float& channel : colour) channel += shift;
    return colour;
  }

  void AddTree(Vector2d at, double radius) {
    const auto tone = static_cast<float>(random_.Uniform(0.8, 1.15));
    const auto warm = static_cast<float>(random_.Uniform(-7, 14));
    scene_.trees.push_back({at,
                            radius,
                            radius * random_.Uniform(1.7, 2.4),
                            {44 * tone, 82 * tone, 66 * tone + warm},
                            static_cast<std::uint32_t>(random_.Bits())});
  }

  void AddParked(Vector2d at, Vector2d forward) {
    VehicleLook look = RandomVehicle(random_);
    if (look.kind == VehicleKind::kTruck) look = RandomVehicle(random_);
    const double turn = random_.Uniform(-0.03, 0.03);
    if (random_.Chance(0.4)) forward = -forward;
    scene_.parked.push_back({look, at, (forward + turn * Right(forward)).normalized()});
  }

  // One house with its garden; `street` points from the house to its street.
  void AddHouse(Vector2d centre, Vector2d street, double lot_width) {
    const Vector2d along = Right(street);
    const double length = random_.Uniform(9, 12.5);
    const double width = random_.Uniform(7.5, 9.5);
    const bool ridge_along = random_.Chance(0.65);
    const double turn = random_.Uniform(-0.04, 0.04);
    const Vector2d ridge =
        ((ridge_along ? along : street) + turn * (ridge_along ? street : -along));
    const auto tint = static_cast<float>(random_.Uniform(-10, 12));
    scene_.plots.push_back({{centre - 4 * street, along, lot_width, 34},
                            GroundKind::kLawn,
                            {58 + 0.3F * tint, 102 + tint, 92 + 1.4F * tint}});
    scene_.buildings.push_back({{centre, ridge.normalized(), length, width},
                                random_.Uniform(3.2, 5.6),
                                random_.Uniform(2.0, 3.2),
                                random_.Chance(0.25) ? RoofKind::kHip : RoofKind::kGable,
                                RoofColour()});
    const double side = random_.Chance(0.5) ? 1 : -1;
    const Vector2d drive = centre + side * (0.5 * lot_width - 2.4) * along + 8.0 * street;
    scene_.plots.push_back({{drive, street, 12, 3.2},
                            random_.Chance(0.5) ? GroundKind::kPaved : GroundKind::kGravel,
                            {136, 140, 144}});
    if (random_.Chance(0.7)) AddParked(drive + random_.Uniform(-2, 2) * street, street);
    if (random_.Chance(0.6)) {  // garage or shed
      const Vector2d shed = centre + side * (0.5 * lot_width - 2.6) * along - 3.0 * street;
      scene_.buildings.push_back(
          {{shed, street, random_.Uniform(4, 6), 3.2}, 2.3, 0.2, RoofKind::kFlat, RoofColour()});
    }
    scene_.hedges.push_back({{centre + 0.5 * lot_width * along - 6 * street, street, 24, 0.9}});
    AddGarden(centre - 13 * street, along, lot_width);
  }

  void AddGarden(Vector2d centre, Vector2d along, double width) {
    const Vector2d deep = Right(along);
    const int trees = 1 + random_.Below(4);
    for (int i = 0; i < trees; ++i) {
      AddTree(centre + random_.Uniform(-0.45, 0.45) * width * along + random_.Uniform(-7, 6) * deep,
              random_.Uniform(1.5, 3.4));
    }
    const int bushes = random_.Below(7);
    for (int i = 0; i < bushes; ++i) {
      AddTree(centre + random_.Uniform(-0.5, 0.5) * width * along + random_.Uniform(-8, 9) * deep,
              random_.Uniform(0.4, 0.9));
    }
    if (random_.Chance(0.4)) {  // path
      scene_.plots.push_back({{centre + random_.Uniform(-4, 4) * along + 4 * deep, deep, 14, 1.1},
                              GroundKind::kGravel,
                              {134, 146, 154}});
    }
    if (random_.Chance(0.5)) {  // vegetable beds
      scene_.plots.push_back({{centre + random_.Uniform(-3, 3) * along, along, 5, 3.5},
                              GroundKind::kField,
                              {66, 84, 104},
                              0.9});
    }
    if (random_.Chance(0.5)) {  // terrace
      scene_.plots.push_back({{centre + random_.Uniform(-3, 3) * along + 7 * deep, along, 5, 3},
                              GroundKind::kPaved,
                              {150, 158, 164}});
    }
    if (random_.Chance(0.12)) {  // pool
      scene_.plots.push_back({{centre, along, 6, 3.2}, GroundKind::kGravel, {176, 150, 92}});
    }
  }

  void BuildResidentialBlock(double from, double to) {
    const double lot = 17;
    for (double x = from + 20; x < to - 14; x += lot) {
      const double y = kSideStreetY + 3 * Sine(x / 40);
      if (!random_.Chance(0.08)) {
        AddHouse({x, y + 17 + random_.Uniform(-1, 1)}, {0, -1}, lot);
      }
      if (!random_.Chance(0.08)) {
        AddHouse({x, y - 17 + random_.Uniform(-1, 1)}, {0, 1}, lot);
      }
      if (random_.Chance(0.5)) {
        AddParked({x + random_.Uniform(-5, 5), y + (random_.Chance(0.5) ? 3.7 : -3.7)}, {1, 0});
      }
      AddHouse({x, y - 62 + random_.Uniform(-2, 2)}, {0, -1}, lot);
    }
    scene_.hedges.push_back(
        {{{0.5 * (from + to), -13}, Vector2d::UnitX(), to - from - 30, 1.1}, 1.6});
    // The green between the gardens and the main road.
    for (int i = 0; i < 9; ++i) {
      AddTree({random_.Uniform(from + 16, to - 16), random_.Uniform(-30, -17)},
              random_.Uniform(0.5, 3.2));
    }
    scene_.plots.push_back(
        {{{0.5 * (from + to), -15.5}, Vector2d(1, 0.03).normalized(), to - from - 26, 1.6},
         GroundKind::kGravel,
         {138, 150, 158}});
  }

  // Rows of bays with cars; `bays` a row.
  void AddParking(Vector2d corner, int rows, int bays) {
    const double bay = 2.6;
    const double row = 5.2;
    const double pitch = 2 * row + 6.5;
    const double width = bays * bay;
    const double depth = rows * pitch;
    scene_.plots.push_back(
        {{corner + Vector2d(width / 2, depth / 2), Vector2d::UnitX(), width + 12, depth + 3},
         GroundKind::kPaved,
         {104, 105, 106}});
    for (int r = 0; r < rows; ++r) {
      for (const double offset : {0.0, row}) {
        const double y = corner.y() + r * pitch + 3.2 + offset + row / 2;
        scene_.plots.push_back({{{corner.x() + width / 2, y}, Vector2d::UnitX(), width, row},
                                GroundKind::kPaved,
                                {108, 109, 110},
                                bay,
                                row});
        for (int b = 0; b < bays; ++b) {
          if (random_.Chance(0.42)) continue;
          AddParked({corner.x() + (b + 0.5) * bay + random_.Uniform(-0.15, 0.15),
                     y + random_.Uniform(-0.3, 0.3)},
                    {0, 1});
        }
      }
    }
  }

  void BuildCommerce(double from, double to) {
    const double middle = 0.5 * (from + to);
    AddParking({from + 22, 17}, 2, 24);
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
    for (int i = 0; i < 6; ++i) AddTree({from + 24 + 12.0 * i, 58 + random_.Uniform(-1, 1)}, 1.9);
  }

  void BuildSmallPlots(double from, double to) {
    for (double x = from + 18; x < to - 12; x += 20) {
      if (random_.Chance(0.5)) {
        AddHouse({x, 30 + random_.Uniform(-2, 2)}, {0, -1}, 19);
      } else {
        AddGarden({x, 28}, {1, 0}, 18);
        AddTree({x + random_.Uniform(-5, 5), 38}, random_.Uniform(2, 3.6));
      }
    }
    for (int i = 0; i < 60; ++i) {  // a small wood
      AddTree({random_.Uniform(from + 14, to - 50), random_.Uniform(54, 100)},
              random_.Uniform(2.0, 4.2));
    }
    scene_.plots.push_back(
        {{{to - 26, 80}, Vector2d::UnitX(), 36, 44}, GroundKind::kGravel, {120, 142, 156}});
    for (int i = 0; i < 8; ++i) {
      AddParked({to - 38 + 3.2 * i, 66 + random_.Uniform(-1, 1)}, {0, 1});
    }
  }

  void BuildFields() {
    static constexpr std::array<Colour, 4> kCrops = {
        {{62, 128, 112}, {78, 112, 132}, {70, 146, 150}, {58, 100, 84}}};
    for (double x = kWest; x < east_; x += 64) {
      scene_.plots.push_back({{{x, 150}, Vector2d(0.12, 1).normalized(), 92, 62},
                              GroundKind::kField,
                              kCrops[random_.Below(kCrops.size())],
                              random_.Uniform(0.8, 1.3)});
      scene_.plots.push_back({{{x, -178}, Vector2d(1, 0.2).normalized(), 70, 60},
                              GroundKind::kField,
                              kCrops[random_.Below(kCrops.size())],
                              random_.Uniform(0.8, 1.3)});
    }
  }

  void BuildStreetTrees() {
    for (double x = kWest; x < east_; x += random_.Uniform(11, 19)) {
      const auto near = [x](double crossing) { return std::abs(crossing - x) < 14; };
      if (std::any_of(crossings_.begin(), crossings_.end(), near)) continue;
      AddTree({x, MainY(x) - 11.2}, random_.Uniform(1.4, 2.5));
      if (random_.Chance(0.55)) AddTree({x + 4, MainY(x) + 11.4}, random_.Uniform(1.3, 2.3));
    }
  }

  Random random_;
  double east_;
  double stop_distance_ = 0;
  std::vector<double> crossings_;
  Scene scene_;
};

}  // namespace

Scene BuildOutskirts(const FlightPlan& plan) { return Outskirts(plan).Build(); }

}  // namespace windhover::replay
