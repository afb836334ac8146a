// SPDX-License-Identifier: Apache-2.0
#include "replay/render/view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "replay/render/clip.h"
#include "replay/render/fill.h"
#include "replay/render/ray_caster.h"
#include "replay/render/shading.h"

namespace windhover::replay {
namespace {

// Side of the squares of pixels that share a bound on the height of what they see.
constexpr int kCell = 4;
// A body this much behind the surface of the land is still seen, m: it stands on it.
constexpr float kContact = 0.08F;
// A shadow falls on what is this near to its height, m.
constexpr float kShadowReach = 0.3F;

}  // namespace

View::View(int width, int rows)
    : width_(width), rows_(rows), pixels_(static_cast<std::size_t>(width) * rows) {}

void View::Draw(const Instant& instant, int first_row, double shift_x, double shift_y) {
  first_row_ = first_row;
  shift_x_ = shift_x;
  shift_y_ = shift_y;
  Eigen::Matrix3d shifted = Eigen::Matrix3d::Identity();
  shifted(0, 2) = shift_x;
  shifted(1, 2) = shift_y;
  rays_ = instant.camera.WorldFromPixel() * shifted;
  DrawLand(instant);
  for (const DrawnBody& body : instant.bodies) DrawShadow(body, instant);
  for (const DrawnBody& body : instant.bodies) {
    for (const Face& face : body.faces) DrawFace(face, body.id, instant.camera);
  }
  DrawAir(instant);
}

// Rays of one instant against all levels of the land.
class View::LandPainter {
 public:
  explicit LandPainter(const Instant& instant)
      : camera_(instant.camera),
        scene_(instant.scene),
        levels_(instant.land.levels()),
        ways_(levels_.size()) {
    for (const Land::Level& level : levels_) {
      casters_.emplace_back(*level.terrain, Eigen::Vector2d(camera_.x_m, camera_.y_m),
                            camera_.altitude_m);
      shadings_.emplace_back(scene_, *level.terrain, instant.time_s);
    }
  }

  // Where the rays of a cell begin to be looked at, for each level.
  void Aim(const RayCaster::Beam& beam) {
    double begin = 0;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      ways_[i] = casters_[i].FreeWayOf(beam, begin, levels_[i].end_m);
      begin = levels_[i].end_m;
      if (ways_[i].flat) break;
    }
  }

  // What a ray of the cell that was aimed at last shows.
  Pixel Look(const Eigen::Vector3d& ray) const {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const double end = levels_[i].end_m;
      const RayCaster::FreeWay& way = ways_[i];
      if (way.depth >= end) continue;
      const Hit hit = way.flat ? casters_[i].Ground(ray) : casters_[i].Cast(ray, way.depth, end);
      if (hit.kind == Hit::Kind::kNone) continue;
      const double length = ray.norm();
      const double across = hit.depth * length / camera_.focal_px;
      const double slant = length / std::max(0.02, std::abs(ray.z()));
      const Shading::Light light = shadings_[i].At(hit, ray, across * std::max(1.0, 0.25 * slant));
      return {light.colour[0],
              light.colour[1],
              light.colour[2],
              static_cast<float>(hit.depth),
              hit.height,
              light.sun,
              0};
    }
    return Beyond(ray);
  }

 private:
  // Where no raster reaches: the plain that goes on for ever, or sky.
  Pixel Beyond(const Eigen::Vector3d& ray) const {
    if (ray.z() > 0) {
      const double depth = camera_.altitude_m / ray.z();
      return {
          scene_.meadow[0], scene_.meadow[1], scene_.meadow[2], static_cast<float>(depth), 0, 1, 0};
    }
    const Colour colour = SkyColour(scene_.sky, ray, scene_.seed);
    return {colour[0], colour[1], colour[2], std::numeric_limits<float>::infinity(), 0, 0, 0};
  }

  const Camera& camera_;
  const Scene& scene_;
  const std::vector<Land::Level>& levels_;
  std::vector<RayCaster> casters_;
  std::vector<Shading> shadings_;
  std::vector<RayCaster::FreeWay> ways_;
};

void View::DrawLand(const Instant& instant) {
  LandPainter painter(instant);
  const auto ray = [this](int x, int row) -> Eigen::Vector3d {
    return rays_ * Eigen::Vector3d(x, first_row_ + row, 1);
  };
  // Cell by cell, so that rays over open ground need no look at what stands on it.
  for (int cell_row = 0; cell_row < rows_; cell_row += kCell) {
    for (int cell_x = 0; cell_x < width_; cell_x += kCell) {
      const int end_row = std::min(rows_, cell_row + kCell);
      const int end_x = std::min(width_, cell_x + kCell);
      painter.Aim({ray(cell_x, cell_row), ray(end_x - 1, cell_row), ray(cell_x, end_row - 1),
                   ray(end_x - 1, end_row - 1)});
      for (int row = cell_row; row < end_row; ++row) {
        for (int x = cell_x; x < end_x; ++x) {
          pixels_[static_cast<std::size_t>(row) * width_ + x] = painter.Look(ray(x, row));
        }
      }
    }
  }
}

void View::DrawShadow(const DrawnBody& body, const Instant& instant) {
  if (body.shadow.empty()) return;
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector2d& spot : body.shadow) {
    corners.emplace_back(spot.x(), spot.y(), body.height_m);
  }
  const Outline outline = VisibleOutline(instant.camera, corners, {shift_x_, shift_y_});
  const auto height = static_cast<float>(body.height_m);
  const float ambient = instant.scene.sun.ambient;
  ForEachPixelInside(outline, 0, width_, first_row_, first_row_ + rows_, [&](int x, int y) {
    Pixel& seen = pixel(x, y);
    if (std::abs(seen.height - height) > kShadowReach) return;
    const float light = 1 - seen.sun * (1 - ambient);
    seen.blue *= light;
    seen.green *= light;
    seen.red *= light;
    seen.sun = 0;
  });
}

void View::DrawFace(const Face& face, std::int64_t id, const Camera& camera) {
  const Outline outline = VisibleOutline(camera, face.corners, {shift_x_, shift_y_});
  if (outline.empty()) return;
  // The face's plane over (dx, dy, drop) from the camera is normal . p = offset; along the ray t *
  // d it is met at t = offset / (normal . d).
  const auto from_camera = [&camera](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p.x() - camera.x_m, p.y() - camera.y_m, camera.altitude_m - p.z());
  };
  const Eigen::Vector3d a = from_camera(face.corners[0]);
  const Eigen::Vector3d normal =
      (from_camera(face.corners[2]) - a)
          .cross(from_camera(face.corners[3]) - from_camera(face.corners[1]));
  const double offset = normal.dot(a);
  ForEachPixelInside(outline, 0, width_, first_row_, first_row_ + rows_, [&](int x, int y) {
    const Eigen::Vector3d ray = rays_ * Eigen::Vector3d(x, y, 1);
    const double facing = normal.dot(ray);
    if (facing == 0) return;
    const double depth = offset / facing;
    Pixel& seen = pixel(x, y);
    const float contact = seen.id == 0 ? kContact : 0.0F;
    if (!(depth > 0) || depth > seen.depth + contact) return;
    seen = {face.colour[0],
            face.colour[1],
            face.colour[2],
            static_cast<float>(depth),
            static_cast<float>(camera.altitude_m - depth * ray.z()),
            seen.sun,
            id};
  });
}

void View::DrawAir(const Instant& instant) {
  const Sky& sky = instant.scene.sky;
  if (!instant.land.far() || sky.haze_m <= 0) return;
  for (int row = 0; row < rows_; ++row) {
    for (int x = 0; x < width_; ++x) {
      Pixel& seen = pixels_[static_cast<std::size_t>(row) * width_ + x];
      if (std::isinf(seen.depth)) continue;
      const double length = (rays_ * Eigen::Vector3d(x, first_row_ + row, 1)).norm();
      const float share = HazeShare(sky, seen.depth * length);
      seen.blue += share * (sky.horizon[0] - seen.blue);
      seen.green += share * (sky.horizon[1] - seen.green);
      seen.red += share * (sky.horizon[2] - seen.red);
    }
  }
}

}  // namespace windhover::replay
