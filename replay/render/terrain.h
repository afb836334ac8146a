// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "replay/render/scene.h"

namespace windhover::replay {

class GroundPhoto;

// Texels of the fixed lattice over the map: texel (i, j) has its centre at texel_m * (i, j). Ends
// are exclusive.
struct TexelRect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  std::size_t area() const { return static_cast<std::size_t>(width()) * height(); }
};

// The part of a scene that stands still, as a raster: what colour each spot has in its light, how
// high it is and what it is made of. What a texel holds depends on the scene and the texel alone,
// not on the rectangle, as long as the rectangle has everything in it that casts a shadow there.
class Terrain {
 public:
  using Height = std::uint16_t;
  static constexpr float kHeightUnit = 0.0025F;  // m
  static constexpr float kMostMetres = 160.0F;
  static constexpr float HeightMetres(Height height) {
    return static_cast<float>(height) * kHeightUnit;
  }
  // Air from the ground up to here, then the thing itself: bridges, crowns. 0: none.
  using Underside = std::uint8_t;
  static constexpr float kUndersideUnit = 0.25F;  // m

  // What a spot is made of.
  using Surface = std::uint16_t;
  static constexpr Surface kSolid = 0;
  static constexpr Surface kFoliage = 1;
  static constexpr Surface kWater = 2;
  static constexpr Surface kTrunk = 3;
  static constexpr Surface kFirstBuilding = 16;  // + its index in the scene

  // Greatest heights are known of blocks with sides of 4, 16, 64 and 256 texels.
  static constexpr int kBlockLevels = 4;
  static constexpr int kBlockShift = 2;
  static constexpr int kAlignment = 1 << (kBlockShift * kBlockLevels);
  // Colours are also known as means over 2, 4, ... 64 texels.
  static constexpr int kMips = 6;

  // The rectangle is widened to whole blocks of the largest side. `photo`, unless null, is what the
  // ground looks like. `go_on`, where there is one, is called before each strip or row from the
  // thread that works on it; what it throws ends the work and comes out here.
  Terrain(const Scene& scene, const GroundPhoto* photo, const TexelRect& rect, double texel_m,
          int threads, const std::function<void()>& go_on = {});

  double texel_m() const { return texel_m_; }
  const TexelRect& rect() const { return rect_; }
  int width() const { return rect_.width(); }
  int height() const { return rect_.height(); }

  // All rasters begin at (rect().x0, rect().y0). Mip 0 has the texels themselves: blue, green, red
  // and the share of the sun that reaches the spot, from the lowest byte on.
  const std::uint32_t* colours(int mip) const { return colours_[mip].data(); }
  const Height* heights() const { return heights_.data(); }
  const Surface* surfaces() const { return surfaces_.data(); }
  const Underside* undersides() const { return undersides_.data(); }
  // Greatest heights of the blocks of a level, 1 to kBlockLevels.
  const Height* highest(int level) const { return highest_[level - 1].data(); }
  int block_width(int level) const { return width() >> (kBlockShift * level); }
  // The greatest height of all, m.
  float highest_of_all() const { return highest_of_all_; }
  // False where no texel that the rectangle touches is higher than this, m. Texel i reaches from i
  // to i + 1 here, counted from the raster's first one; the rectangle may reach outside.
  bool MayExceed(double x0, double y0, double x1, double y1, double metres) const;

  // Share of the sun that reaches a spot of the map, 0 to 1; 1 outside the raster.
  float SunAt(const Eigen::Vector2d& spot) const;

 private:
  void Paint(const Scene& scene, const GroundPhoto* photo, int threads,
             const std::function<void()>& go_on);
  void FindHighest();
  void Light(const Scene& scene, int threads, const std::function<void()>& go_on);
  // Whether anything may stand between a block of shadows and the sun.
  bool MayBeShaded(int block_x, int block_y, float step_x, float step_y, float rise) const;
  void LightRow(const Scene& scene, int y, const std::vector<std::uint8_t>& lit);
  void MakeMips(int threads);

  TexelRect rect_;
  double texel_m_;
  std::array<std::vector<std::uint32_t>, kMips + 1> colours_;
  std::vector<Height> heights_;
  std::vector<Surface> surfaces_;
  std::vector<Underside> undersides_;
  std::array<std::vector<Height>, kBlockLevels> highest_;
  float highest_of_all_ = 0;
};

}  // namespace windhover::replay
