// SPDX-License-Identifier: Apache-2.0
#include "replay/render/land.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover::replay {
namespace {

// A raster's texel is this share of the smallest ground pixel of the flight.
constexpr double kTexelShare = 0.5;
constexpr double kLeastTexel = 0.03;  // m
// A raster is seen until its texels are this share of a pixel; the next one is as much coarser.
constexpr double kTexelsEnd = 0.28;
constexpr double kCoarser = 2.6;
// Beyond this there is only haze, m along the optical axis.
constexpr double kMostDepth = 6000;
// What one flight's finest raster may take, with about 11 bytes a texel.
constexpr double kMostTexels = 70e6;
constexpr double kMargin = 14;  // m

struct Reach {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;

  void Add(const Eigen::Vector2d& spot) {
    low = low.cwiseMin(spot);
    high = high.cwiseMax(spot);
  }
  bool empty() const { return !(low.x() <= high.x()); }
  double area() const { return empty() ? 0 : (high - low).prod(); }
};

// The map's rectangle that a camera may see between the depths `begin` and `end`, up to the height
// of what stands on it.
void AddReach(const Camera& camera, const FlightPlan& plan, double highest, double begin,
              double end, Reach& reach) {
  constexpr int kColumns = 16;
  // Near the horizon neighbouring rays meet the ground far apart.
  constexpr int kRows = 192;
  const Eigen::Matrix3d rays = camera.WorldFromPixel();
  const Eigen::Vector2d origin(camera.x_m, camera.y_m);
  const auto add_ray = [&](double u, double v) {
    const Eigen::Vector3d ray =
        rays * Eigen::Vector3d(u * (plan.width - 1), v * (plan.height - 1), 1);
    double from = begin;
    double to = end;
    if (ray.z() > 0) {
      from = std::max(from, (camera.altitude_m - highest) / ray.z());
      to = std::min(to, camera.altitude_m / ray.z());
    } else if (ray.z() < 0) {
      to = std::min(to, (camera.altitude_m - highest) / ray.z());
    }
    if (!(from <= to)) return;
    reach.Add(origin + std::max(0.0, from) * ray.head<2>());
    reach.Add(origin + to * ray.head<2>());
  };
  for (int i = 0; i <= kColumns; ++i) {
    for (int j = 0; j <= kRows; ++j) {
      add_ray(static_cast<double>(i) / kColumns, static_cast<double>(j) / kRows);
    }
  }
}

Reach ReachOf(const CameraPath& path, const FlightPlan& plan, double highest, double begin,
              double end, int frames) {
  Reach reach;
  for (int frame = -1; frame <= frames; ++frame) {
    AddReach(path.At(frame), plan, highest, begin, end, reach);
  }
  return reach;
}

TexelRect RectOf(const Reach& reach, double margin, double texel_m) {
  const auto texel = [texel_m](double metres) {
    return static_cast<int>(std::floor(metres / texel_m));
  };
  return {texel(reach.low.x() - margin), texel(reach.low.y() - margin),
          texel(reach.high.x() + margin) + 1, texel(reach.high.y() + margin) + 1};
}

double GreatestFocal(const CameraPath& path, int frames) {
  double focal = 0;
  for (int frame = 0; frame <= frames; ++frame) focal = std::max(focal, path.At(frame).focal_px);
  return focal;
}

}  // namespace

Land::Land(const Scene& scene, const FlightPlan& plan, const CameraPath& path, int frames,
           int threads, const std::function<void()>& go_on) {
  if (!plan.ground.empty()) {
    photo_ = std::make_unique<const GroundPhoto>(plan.ground, plan.ground_pixel_m);
  }
  const double highest = scene.Highest();
  const double focal = GreatestFocal(path, plan.frames);
  const Eigen::Vector3d& sun = scene.sun.direction;
  const double shadow = highest * sun.head<2>().norm() / sun.z();
  double texel = std::max(kTexelShare * path.pixel_m(), kLeastTexel);
  // The texels follow from the whole flight, so that a part of it shows the same.
  double end = std::min(texel * focal / kTexelsEnd, kMostDepth);
  for (;; texel *= 1.1, end = std::min(texel * focal / kTexelsEnd, kMostDepth)) {
    const Reach whole = ReachOf(path, plan, highest, 0, end, plan.frames);
    if (whole.area() / (texel * texel) < kMostTexels) break;
  }
  far_ =
      end < kMostDepth &&
      !ReachOf(path, plan, highest, end, std::min(end * kCoarser, kMostDepth), plan.frames).empty();
  for (double begin = 0;;
       begin = end, texel *= kCoarser, end = std::min(end * kCoarser, kMostDepth)) {
    const Reach reach = ReachOf(path, plan, highest, begin, end, frames);
    if (!reach.empty()) {
      const double margin = kMargin + shadow + 0.03 * end;
      levels_.push_back(
          {std::make_unique<const Terrain>(scene, photo_.get(), RectOf(reach, margin, texel), texel,
                                           threads, go_on),
           end});
    }
    if (reach.empty() || end >= kMostDepth) break;
  }
}

float Land::SunAt(const Eigen::Vector2d& spot, double depth_m) const {
  for (const Level& level : levels_) {
    if (depth_m < level.end_m) return level.terrain->SunAt(spot);
  }
  return 1.0F;
}

}  // namespace windhover::replay
