// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "replay/render/scene.h"

namespace windhover::replay {

// The part of a scene that stands still, as a raster: what colour each spot has in its light, and
// how high it is. Texel (i, j) has its centre at origin + texel_m * (i, j).
class Terrain {
 public:
  // Heights in cm; the lowest bit is set where the spot is foliage.
  using Height = std::uint16_t;
  static constexpr Height kFoliage = 1;
  static constexpr float HeightMetres(Height height) {
    return static_cast<float>(height & ~kFoliage) * 0.01F;
  }

  // Side of the blocks whose greatest heights are known, texels.
  static constexpr int kBlock = 8;

  // From `low` to `high` of the map. `go_on`, where there is one, is called before each strip or
  // row from the thread that works on it; what it throws ends the work and comes out here.
  Terrain(const Scene& scene, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
          double texel_m, int threads, const std::function<void()>& go_on = {});

  double texel_m() const { return texel_m_; }
  const Eigen::Vector2d& origin() const { return origin_; }
  int width() const { return width_; }
  int height() const { return height_; }

  // Blue, green, red and the share of the sun that reaches the spot, from the lowest byte on.
  const std::uint32_t* colours() const { return colours_.data(); }
  const Height* heights() const { return heights_.data(); }
  // The greatest height of all, m.
  float highest() const { return highest_of_all_; }
  // No texel of the rectangle, which may reach outside, is higher than this, m.
  float HighestIn(float x0, float y0, float x1, float y1) const;
  // The greatest height, m, within kBlock texels of the texel at least.
  float highest_around(int x, int y) const {
    return highest_around_[static_cast<std::size_t>(y / kBlock) * blocks_x_ + x / kBlock];
  }
  // Share of the sun at a spot of the map, 0 to 1; 1 outside.
  float SunAt(const Eigen::Vector2d& spot) const;

 private:
  void Paint(const Scene& scene, int threads, const std::function<void()>& go_on);
  void FindHighest();
  void Light(const Scene& scene, int threads, const std::function<void()>& go_on);

  Eigen::Vector2d origin_;
  double texel_m_;
  int width_;
  int height_;
  int blocks_x_ = 0;
  int blocks_y_ = 0;
  std::vector<std::uint32_t> colours_;
  std::vector<Height> heights_;
  // Greatest heights of each block, of it with its eight neighbours, and of all.
  std::vector<float> highest_;
  std::vector<float> highest_around_;
  float highest_of_all_ = 0;
};

}  // namespace windhover::replay
