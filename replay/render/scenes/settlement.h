// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"

namespace windhover::replay {

// What the builders of scenes share: pieces of a settlement and of the land around it, each with
// its own random numbers, so that one more of a kind moves nothing of another kind. Lengths in m.
class Settlement {
 public:
  Settlement(std::uint64_t seed, Scene& scene) : seed_(seed), scene_(scene) {}

  // A crown of `radius`; about twice as high.
  void AddTree(const Eigen::Vector2d& at, double radius);
  void AddTree(const Eigen::Vector2d& at, double radius, const Colour& leaves);
  // `count` trees strewn over the area, with radii in the range.
  void AddWood(const Area& area, int count, double radius_low, double radius_high);
  // Trees along the line at the distance, with gaps.
  void AddTreeRow(const Path& path, double right, double spacing, double radius_low,
                  double radius_high);
  // A vehicle about along `forward`, either way round.
  void AddParked(const Eigen::Vector2d& at, const Eigen::Vector2d& forward);
  // A house with drive, garage and garden; `street` points from the house to its street.
  void AddHouse(const Eigen::Vector2d& centre, const Eigen::Vector2d& street, double lot_width);
  void AddGarden(const Eigen::Vector2d& centre, const Eigen::Vector2d& along, double width);
  // `rows` double rows of `bays` with cars in about `taken` of them, from a corner along +x and +y.
  void AddParking(const Eigen::Vector2d& corner, int rows, int bays, double taken);
  void AddField(const Area& area);
  // Houses, barns and a yard around `centre`.
  void AddFarm(const Eigen::Vector2d& centre, const Eigen::Vector2d& forward);
  // One lane for each direction, `lateral` to the right of the line. The lights are those of the
  // forward lane, the same distance before their junctions from the other side.
  void AddLanes(const Path& path, double lateral, double spacing, double speed_low,
                double speed_high, const std::vector<Lane::Light>& lights = {},
                double stop_distance = 0);

  Colour RoofColour();

 private:
  enum class Piece : std::uint8_t {
    kTree,
    kWood,
    kRow,
    kParked,
    kHouse,
    kGarden,
    kParking,
    kField,
    kFarm,
    kRoof,
    kCount
  };
  Random RandomFor(Piece piece);

  std::uint64_t seed_;
  Scene& scene_;
  std::array<std::uint64_t, static_cast<std::size_t>(Piece::kCount)> made_{};
};

// The line y(x) from x0 to x1, in steps of 4 m.
template <typename Curve>
Path LineAlongX(double x0, double x1, Curve&& y) {
  std::vector<Eigen::Vector2d> points;
  for (double x = x0; x <= x1 + 1e-9; x += 4) points.emplace_back(x, y(x));
  return Path(std::move(points));
}

}  // namespace windhover::replay
