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

enum class GroundKind { kLawn, kField, kPaved, kGravel, kSlabs, kForest, kWater };

// A piece of ground; later ones lie on earlier ones.
struct Plot {
  Area area;
  GroundKind kind = GroundKind::kLawn;
  Colour colour{};
  // Distance of a field's rows; of painted bays on paved ground; side of slabs; 0: none.
  double row_m = 0.0;
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

enum class FacadeKind { kPlaster, kBalconies, kBands, kGlass, kBlank };

// What the walls of a building look like.
struct Facade {
  FacadeKind kind = FacadeKind::kPlaster;
  Colour colour = {168, 178, 184};
  float floor = 2.8F;  // m, height of a storey
  float bay = 2.6F;    // m, from window to window
};

struct Building {
  Area area;           // length along the ridge
  double eaves = 4.0;  // m above the ground
  double rise = 2.5;   // m from the eaves to the ridge; height of the parapet on a flat roof
  RoofKind roof = RoofKind::kGable;
  Colour colour{};  // of the roof
  Facade facade{};
};

struct Tree {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 2.5;  // m
  double height = 6.0;  // m
  Colour colour{};
  std::uint32_t seed = 0;
  bool trunk = true;  // stands on a trunk with air around it; else the crown reaches the ground
};

struct Hedge {
  Area area;
  double height = 1.4;  // m
};

// A post, a column, a mast.
struct Pole {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0.12;  // m
  double height = 7.0;   // m
  Colour colour = {120, 122, 122};
  // A street lamp's arm reaches this far along `arm`, m; 0: none.
  double arm_m = 0.0;
  Eigen::Vector2d arm = Eigen::Vector2d::UnitX();
};

// A wall or a fence.
struct Wall {
  Area area;
  double height = 1.6;  // m
  Colour colour = {120, 130, 138};
};

// A flat roof on thin legs, or an umbrella where it is round: air beneath.
struct Canopy {
  Area area;
  double height = 2.4;  // m
  bool round = false;
  Colour colour{};
};

// A way that leads over others: its height is that of `knots` over its length, linear between them.
// It stands on banks, and as a deck on air between `open_from_m` and `open_to_m`.
struct Bridge {
  Path path;
  double width = 9.0;       // m, with its parapets
  double lane_width = 3.5;  // m
  std::vector<HeightKnot> knots;
  double open_from_m = 0.0;
  double open_to_m = 0.0;
};

// A flag on a pole, moved by the wind.
struct Flag {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();
  double height = 9.0;  // m, of its upper edge
  double length = 2.4;  // m
  double drop = 1.5;    // m, of the cloth
  std::array<Colour, 3> bands{};
  std::uint32_t seed = 0;
};

// Smooth relief of the whole ground.
struct Relief {
  double height_m = 0.0;  // of the dunes; 0: flat
  double length_m = 60;   // from crest to crest
  double ripple_m = 0.0;  // height of the wind's ripples
  double edge_y_m = 1e9;  // no relief beyond this line
};

// What is seen over the horizon and through the air.
struct Sky {
  Colour horizon = {222, 212, 200};
  Colour zenith = {196, 148, 96};
  float clouds = 0.5F;   // 0: none, 1: overcast
  double haze_m = 5200;  // at this distance the air's own light has taken over by 63 %
};

// Moves everything that the wind moves.
struct Wind {
  Eigen::Vector2d direction = Eigen::Vector2d(0.8, 0.6);
  double sway_m = 0.16;  // how far leaves swing
};

// A person is a vehicle, too: what can be in the way of a picture is the same for both.
enum class VehicleKind { kCar, kVan, kTruck, kPerson };

struct VehicleLook {
  VehicleKind kind = VehicleKind::kCar;
  Colour paint{};
  double length = 4.4;  // m
  double width = 1.85;
  double height = 1.45;
  Colour glass = {108, 100, 92};
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
  std::vector<Pole> poles;
  std::vector<Wall> walls;
  std::vector<Canopy> canopies;
  std::vector<Bridge> bridges;
  std::vector<Flag> flags;
  Relief relief{};
  Sky sky{};
  Wind wind{};
  float glint = 1.0F;  // of the sun in waves; 0: none
  std::vector<ParkedVehicle> parked;
  std::vector<Lane> lanes;
  std::vector<Walk> walks;
  double traffic_contrast = 1.0;  // of the plan
  // Seen by its warmth: colours are grey levels of a thermal camera.
  bool thermal = false;

  // No part of the scene is higher than this, m.
  double Highest() const;
  // Height of the bare ground at a spot of the map, m.
  float GroundAt(float x, float y) const;
};

// The scene below the flight; the same for the same plan.
Scene BuildScene(const FlightPlan& plan);

// What BuildScene calls for SceneKind::kOutskirts: a four-lane road with a residential side, a side
// of commerce and fields, and streets that cross it.
Scene BuildOutskirts(const FlightPlan& plan);

Scene BuildTowers(const FlightPlan& plan);       // avenues between towers
Scene BuildStreets(const FlightPlan& plan);      // old blocks, cars along every kerb
Scene BuildSquare(const FlightPlan& plan);       // cafes, a fountain, people
Scene BuildInterchange(const FlightPlan& plan);  // two motorways, one on a bridge
Scene BuildCountry(const FlightPlan& plan);      // one road between fields, hedges and farms
Scene BuildDunes(const FlightPlan& plan);        // sand and planted forest, a track between
Scene BuildValley(const FlightPlan& plan);       // a road through villages, seen to the horizon
Scene BuildHarbour(const FlightPlan& plan);      // sheds and containers by night, as warmth
Scene BuildHighway(const FlightPlan& plan);      // two carriageways, a service road, works
Scene BuildSuburb(const FlightPlan& plan);       // streets of houses with fields between

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
// Its paint or clothes `contrast` times as far from asphalt, within 8 to 247 grey levels.
VehicleLook WithContrast(VehicleLook look, double contrast);
// As a thermal camera sees it, `warm` with that probability: brighter than the ground, or darker
// where its skin mirrors the cold sky; else hardly different from the ground.
VehicleLook ThermalLook(VehicleLook look, double warm, Random& random);

}  // namespace windhover::replay
