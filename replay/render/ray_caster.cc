// SPDX-License-Identifier: Apache-2.0
#include "replay/render/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"

namespace windhover::replay {
namespace {

// Sides lower than this, m, are steps of a slope.
constexpr float kStep = 0.35F;
// How far beyond an edge a ray is looked at to know the texel behind it, texels.
constexpr double kBeyond = 1e-5;
constexpr double kFar = 1e30;  // depth to an edge that is never met
// Steps of a beam over the raster, texels.
constexpr double kLongestStep = 160;
constexpr double kShortestStep = 3;

}  // namespace

// A ray on its way; `x`, `y`, `slope_x`, `slope_y` in texels, depths in lengths of the direction.
struct RayCaster::Walk {
  double slope_x;
  double slope_y;
  double drop;
  double per_x = 0;  // depth from texel to texel
  double per_y = 0;
  bool right = true;
  bool down = true;
  double depth = 0;
  int column = 0;  // of the raster
  int row = 0;
};

RayCaster::RayCaster(const Terrain& terrain, const Eigen::Vector2d& origin, double height_m)
    : terrain_(terrain),
      height_(height_m),
      per_metre_(1 / terrain.texel_m()),
      slope_step_(std::max(kStep, 1.2F * static_cast<float>(terrain.texel_m()))) {
  const double x = origin.x() / terrain.texel_m() + 0.5;
  const double y = origin.y() / terrain.texel_m() + 0.5;
  base_x_ = Floor(x) - terrain.rect().x0;
  base_y_ = Floor(y) - terrain.rect().y0;
  inside_x_ = x - Floor(x);
  inside_y_ = y - Floor(y);
}

RayCaster::FreeWay RayCaster::FreeWayOf(const Beam& beam, double begin, double end) const {
  double most_drop = beam[0].z();
  double least_drop = most_drop;
  double slope = 0;  // of the beam's fastest side over the raster, texels
  for (const Eigen::Vector3d& ray : beam) {
    most_drop = std::max(most_drop, ray.z());
    least_drop = std::min(least_drop, ray.z());
    slope = std::max(slope, ray.head<2>().cwiseAbs().maxCoeff() * per_metre_);
  }
  const double highest = terrain_.highest_of_all();
  if (most_drop > 0) begin = std::max(begin, (height_ - highest) / most_drop);
  if (begin >= end) return {end, false};
  // All rays have met the ground from here on.
  const double ground = least_drop > 0 ? height_ / least_drop : kFar;
  const double last = std::min(end, ground);
  const double shortest = kShortestStep / std::max(slope, kShortestStep / (end - begin));
  FreeWay way = {begin, false};
  // Mostly the whole rest is free; grazing rays go on in steps.
  double step = slope * (last - begin) > kLongestStep ? kLongestStep / slope : last - begin;
  while (way.depth < last) {
    const double next = std::min(way.depth + step, last);
    const double lowest = height_ - (most_drop > 0 ? next : way.depth) * most_drop;
    if (Touches(beam, way.depth, next, std::max(lowest - 1e-3, 0.0))) {
      step *= 0.5;
      if (step < shortest) break;
      continue;
    }
    way.depth = next;
    step = std::min(1.5 * step, kLongestStep / std::max(slope, kLongestStep / (end - begin)));
  }
  way.flat = way.depth == ground;
  // Else some rays have met the ground before.
  if (!way.flat && most_drop > 0) way.depth = std::min(way.depth, height_ / most_drop);
  return way;
}

// Whether the beam, between the two depths, is over anything higher than this, m.
bool RayCaster::Touches(const Beam& beam, double near, double far, double metres) const {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kFar);
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector3d& ray : beam) {
    const Eigen::Vector2d flat = per_metre_ * ray.head<2>();
    low = low.cwiseMin(near * flat).cwiseMin(far * flat);
    high = high.cwiseMax(near * flat).cwiseMax(far * flat);
  }
  // A little more, for the rounding of rays.
  const double x = inside_x_ + base_x_;
  const double y = inside_y_ + base_y_;
  return terrain_.MayExceed(low.x() + x - 0.01, low.y() + y - 0.01, high.x() + x + 0.01,
                            high.y() + y + 0.01, metres);
}

Hit RayCaster::At(const Walk& walk, double depth, float height, Hit::Kind kind) const {
  return {kind,
          depth,
          inside_x_ + depth * walk.slope_x + (base_x_ + terrain_.rect().x0),
          inside_y_ + depth * walk.slope_y + (base_y_ + terrain_.rect().y0),
          height,
          static_cast<std::size_t>(walk.row) * terrain_.width() + walk.column};
}

// The ray enters a texel's column at walk.depth and leaves it at `leave`; somewhere between it is
// not above the top.
bool RayCaster::MeetColumn(const Walk& walk, double leave, Hit& hit) const {
  const std::size_t texel = static_cast<std::size_t>(walk.row) * terrain_.width() + walk.column;
  const float top = Terrain::HeightMetres(terrain_.heights()[texel]);
  const double enter = height_ - walk.depth * walk.drop;
  if (enter > top) {
    hit = At(walk, (height_ - top) / walk.drop, top, Hit::Kind::kTop);
    return true;
  }
  const float underside =
      static_cast<float>(terrain_.undersides()[texel]) * Terrain::kUndersideUnit;
  if (underside == 0 || enter >= underside) {
    const bool slope = top - enter < slope_step_ && underside == 0;
    hit =
        At(walk, walk.depth, static_cast<float>(enter), slope ? Hit::Kind::kTop : Hit::Kind::kWall);
    return true;
  }
  const double exit = height_ - leave * walk.drop;
  if (exit <= 0) {
    hit = At(walk, height_ / walk.drop, 0, Hit::Kind::kBeneath);
    return true;
  }
  if (exit >= underside) {
    hit = At(walk, (height_ - underside) / walk.drop, underside, Hit::Kind::kWall);
    return true;
  }
  return false;
}

Hit RayCaster::Ground(const Eigen::Vector3d& direction) const {
  Walk walk = {direction.x() * per_metre_, direction.y() * per_metre_, direction.z()};
  walk.depth = height_ / walk.drop;
  Hit hit = At(walk, walk.depth, 0, Hit::Kind::kTop);
  const int column = std::clamp(Floor(hit.x) - terrain_.rect().x0, 0, terrain_.width() - 1);
  const int row = std::clamp(Floor(hit.y) - terrain_.rect().y0, 0, terrain_.height() - 1);
  hit.texel = static_cast<std::size_t>(row) * terrain_.width() + column;
  return hit;
}

// Texel by texel, from the one the walk is in to the edge of its smallest block.
bool RayCaster::CrossBlock(Walk& walk, Hit& hit) const {
  constexpr int kEdge = (1 << Terrain::kBlockShift) - 1;
  const int step_x = walk.right ? 1 : -1;
  const int step_y = walk.down ? 1 : -1;
  // A block's last texel has a neighbour in the next block: where it begins, seen from there.
  const int last_x = walk.right ? kEdge : 0;
  const int last_y = walk.down ? kEdge : 0;
  const double far_x = (walk.right ? 1 : 0) - base_x_ - inside_x_;
  const double far_y = (walk.down ? 1 : 0) - base_y_ - inside_y_;
  double at_x = (walk.column + far_x) * walk.per_x;
  double at_y = (walk.row + far_y) * walk.per_y;
  const Terrain::Height* tops = terrain_.heights();
  for (;;) {
    const bool leave_x = at_x < at_y;
    const double leave = std::max(leave_x ? at_x : at_y, walk.depth);
    const double lowest = height_ - (walk.drop > 0 ? leave : walk.depth) * walk.drop;
    const std::size_t texel = static_cast<std::size_t>(walk.row) * terrain_.width() + walk.column;
    if (lowest <= Terrain::HeightMetres(tops[texel]) && MeetColumn(walk, leave, hit)) return true;
    walk.depth = leave;
    if (leave_x) {
      if ((walk.column & kEdge) == last_x) return false;
      walk.column += step_x;
      at_x = (walk.column + far_x) * walk.per_x;
    } else {
      if ((walk.row & kEdge) == last_y) return false;
      walk.row += step_y;
      at_y = (walk.row + far_y) * walk.per_y;
    }
  }
}

Hit RayCaster::Cast(const Eigen::Vector3d& direction, double begin, double end) const {
  Walk walk = {direction.x() * per_metre_, direction.y() * per_metre_, direction.z()};
  const double highest = terrain_.highest_of_all();
  if (walk.drop > 0) begin = std::max(begin, (height_ - highest) / walk.drop);
  if (walk.drop < 0) end = std::min(end, (height_ - highest) / walk.drop);
  if (walk.drop == 0 && height_ > highest) return {};
  walk.per_x = walk.slope_x == 0 ? kFar : 1 / walk.slope_x;
  walk.per_y = walk.slope_y == 0 ? kFar : 1 / walk.slope_y;
  walk.right = walk.slope_x >= 0;
  walk.down = walk.slope_y >= 0;
  const double beyond = kBeyond * std::min(std::abs(walk.per_x), std::abs(walk.per_y));
  const auto width = static_cast<unsigned>(terrain_.width());
  const auto height = static_cast<unsigned>(terrain_.height());
  int level = 1;
  walk.depth = begin;
  while (walk.depth < end) {
    const double inside = walk.depth + beyond;
    walk.column = Floor(inside_x_ + inside * walk.slope_x) + base_x_;
    walk.row = Floor(inside_y_ + inside * walk.slope_y) + base_y_;
    if (static_cast<unsigned>(walk.column) >= width || static_cast<unsigned>(walk.row) >= height) {
      return {};
    }
    // Down through the levels to the first block that the ray passes over.
    for (;; --level) {
      const int shift = level * Terrain::kBlockShift;
      const int block_x = walk.column >> shift;
      const int block_y = walk.row >> shift;
      const int edge_x = (block_x + (walk.right ? 1 : 0)) << shift;
      const int edge_y = (block_y + (walk.down ? 1 : 0)) << shift;
      const double at_x = (edge_x - base_x_ - inside_x_) * walk.per_x;
      const double at_y = (edge_y - base_y_ - inside_y_) * walk.per_y;
      const bool leave_x = at_x < at_y;
      const double leave = std::max(leave_x ? at_x : at_y, inside);
      const double lowest = height_ - (walk.drop > 0 ? leave : walk.depth) * walk.drop;
      const std::size_t block =
          static_cast<std::size_t>(block_y) * terrain_.block_width(level) + block_x;
      if (lowest <= Terrain::HeightMetres(terrain_.highest(level)[block])) {
        if (level > 1) continue;
        Hit hit;
        if (CrossBlock(walk, hit)) {
          if (hit.depth >= end) hit.kind = Hit::Kind::kNone;
          return hit;
        }
      }
      walk.depth = leave;
      // Over the edge of the next larger block, too: go on in larger steps.
      const int crossed = (leave_x ? edge_x : edge_y) >> shift;
      if (level < Terrain::kBlockLevels && (crossed & 3) == 0) ++level;
      break;
    }
  }
  return {};
}

}  // namespace windhover::replay
