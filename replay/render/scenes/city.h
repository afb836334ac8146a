// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {

// What the builders of towns share: blocks between streets, each with its own random numbers. An
// `index` tells pieces of one kind apart. Lengths in m.
class City {
 public:
  City(std::uint64_t seed, Scene& scene, Settlement& pieces)
      : seed_(seed), scene_(scene), pieces_(pieces) {}

  // One or two towers of `low` to `high` m on a paved block, with low wings and some trees.
  void AddTowers(const Area& block, double low, double high, int index);
  // Houses of several storeys all along the edges of a block, and what lies in the yard.
  void AddPerimeter(const Area& block, double low, double high, int index);
  // Lawns, paths and trees.
  void AddPark(const Area& block, int index);
  // Cars parked one behind the other along both kerbs of a straight street, `taken` of the places.
  void AddParkedRows(const Path& street, double right, double taken, int index);
  // Lamps with an arm over the road, to the right of the line.
  void AddLamps(const Path& street, double right, double spacing);
  // Low walls, bins, posts and boxes strewn along a pavement.
  void AddClutter(const Path& street, double right, int index);

 private:
  enum class Piece : std::uint8_t { kTowers, kPerimeter, kPark, kRows, kClutter };
  Random RandomFor(Piece piece, int index) const;
  Facade RandomFacade(Random& random, bool tall) const;

  std::uint64_t seed_;
  Scene& scene_;
  Settlement& pieces_;
};

// A grid of streets along x and y with traffic lights where they meet.
struct StreetGrid {
  std::vector<double> along_x;  // y of the streets that run along x
  std::vector<double> along_y;  // x of the streets that run along y
  double low_x = 0;             // how far the streets run
  double high_x = 0;
  double low_y = 0;
  double high_y = 0;
  double width_x = 9;  // of the carriageways along x
  double width_y = 9;
  int lanes_x = 2;
  int lanes_y = 2;
  double pavement = 3;
  double spacing_x = 40;  // between vehicles of a lane
  double spacing_y = 40;
  double speed_low = 8;
  double speed_high = 13;
};

// Roads, junctions, lanes and lights of the grid.
void AddStreets(const StreetGrid& grid, std::uint64_t seed, Scene& scene, Settlement& pieces);

}  // namespace windhover::replay
