// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "replay/render/flight_plan.h"
#include "replay/render/lane.h"
#include "replay/render/path.h"

namespace windhover::replay {

// Blue, green, red in grey levels under full sun, 0 to 255.
using Colour = std::array<float, 3>;

// A rectangle on the map.
struct Area {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d forward = Eigen::Vector2d::UnitX();  // direction of its length, unit
  double length = 0.0;                                 // m
  double width = 0.0;                                  // m
};

enum class GroundKind { kLawn, kField, kPaved, kGravel };

// A piece of ground; later ones lie on earlier ones.
struct Plot {
  Area area;
  GroundKind kind = GroundKind::kLawn;
  Colour colour{};
  double row_m = 0.0;  // distance of a field's rows; of painted bays on paved ground; 0: none
  double row_length_m = 0.0;  // painted bays only
};

struct Road {
  Path path;
  double width = 7.0;     // m, of the carriageway
  int lanes = 2;          // even: half of them in each direction
  double pavement = 0.0;  // m, footway on either side
  bool marked = true;     // painted lines
};

// Where two roads meet: no lines inside, stop lines and crossings before it.
struct Junction {
  Area area;
};

enum class RoofKind { kGable, kHip, kFlat };

struct Building {
  Area area;           // length along the ridge
  double eaves = 4.0;  // m above the ground
  double rise = 2.5;   // m from the eaves to the ridge; height of the parapet on a flat roof
  RoofKind roof = RoofKind::kGable;
  Colour colour{};
};

struct Tree {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 2.5;  // m
  double height = 6.0;  // m
  Colour colour{};
  std::uint32_t seed = 0;
};

struct Hedge {
  Area area;
  double height = 1.4;  // m
};

// A person is a vehicle, too: what can be in the way of a picture is the same for both.
enum class VehicleKind { kCar, kVan, kTruck, kPerson };

struct VehicleLook {
  VehicleKind kind = VehicleKind::kCar;
  Colour paint{};
  double length = 4.4;  // m
  double width = 1.85;
  double height = 1.45;
  Colour glass = {62, 56, 50};
};

// A vehicle that never moves.
struct ParkedVehicle {
  VehicleLook look;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Vector2d forward = Eigen::Vector2d::UnitX();
};

struct Sun {
  Eigen::Vector3d direction;  // to the sun: (x, y, up), unit length
  float ambient = 0.42F;      // light in full shade as a share of flat ground in the sun
};

// A world that stands still, and the ways on which it moves.
struct Scene {
  std::uint64_t seed = 0;
  Sun sun{};
  Colour meadow{};  // what lies where nothing else does
  std::vector<Plot> plots;
  std::vector<Road> roads;
  std::vector<Junction> junctions;
  std::vector<Building> buildings;
  std::vector<Tree> trees;
  std::vector<Hedge> hedges;
  std::vector<ParkedVehicle> parked;
  std::vector<Lane> lanes;
  std::vector<Walk> walks;
  // Seen by its warmth: colours are grey levels of a thermal camera.
  bool thermal = false;
};

// The scene below the flight; the same for the same plan.
Scene BuildScene(const FlightPlan& plan);

// What BuildScene calls for SceneKind::kOutskirts: a four-lane road with a residential side, a side
// of commerce and fields, and streets that cross it.
Scene BuildOutskirts(const FlightPlan& plan);

Scene BuildCountry(const FlightPlan& plan);  // one road between fields, hedges and farms
Scene BuildDunes(const FlightPlan& plan);    // sand and planted forest, a track between
Scene BuildValley(const FlightPlan& plan);   // a road through villages, seen to the horizon
Scene BuildHarbour(const FlightPlan& plan);  // sheds and containers by night, as warmth
Scene BuildHighway(const FlightPlan& plan);  // two carriageways, a service road, works
Scene BuildSuburb(const FlightPlan& plan);   // streets of houses with fields between

// `share` of the way from a to b.
inline Colour Between(const Colour& a, const Colour& b, float share) {
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}

class Random;
// A vehicle as the traffic has it: most are cars, and about one in five hardly differs from
// asphalt.
VehicleLook RandomVehicle(Random& random);
// A person in summer clothes; one in four hardly differs from asphalt.
VehicleLook RandomPerson(Random& random);
// As a thermal camera sees it, `warm` with that probability: brighter than the ground, or darker
// where its skin mirrors the cold sky; else hardly different from the ground.
VehicleLook ThermalLook(VehicleLook look, double warm, Random& random);

}  // namespace windhover::replay
