// SPDX-License-Identifier: Apache-2.0
#include "replay/render/view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "replay/render/fill.h"

namespace windhover::replay {
namespace {

// Side of the squares of pixels that share a bound on the height of what they see.
constexpr int kCell = 16;

// What a ray sees: where on the raster, in texels, and how high.
struct Hit {
  float x;
  float y;
  float height;
  bool wall;
  bool foliage;
};

// Follows rays down to the terrain.
class RayCaster {
 public:
  RayCaster(const Terrain& terrain, const Camera& camera)
      : terrain_(terrain),
        camera_x_(static_cast<float>((camera.x_m - terrain.origin().x()) / terrain.texel_m())),
        camera_y_(static_cast<float>((camera.y_m - terrain.origin().y()) / terrain.texel_m())),
        altitude_(static_cast<float>(camera.altitude_m)) {}

  // A height that no ray exceeds where it meets something, m: for rays that meet the ground in this
  // rectangle, texels.
  float Ceiling(float x0, float y0, float x1, float y1) const {
    float ceiling = terrain_.highest();
    // The rays lean towards the camera: what can hide the rectangle lies between it and its shift.
    for (int i = 0; i < 3 && ceiling > 0; ++i) {
      const float share = ceiling / altitude_;
      const auto reach = [&](float low, float high, float camera) {
        return std::pair(std::min(low, low + share * (camera - low)),
                         std::max(high, high + share * (camera - high)));
      };
      const auto [left, right] = reach(x0, x1, camera_x_);
      const auto [top, bottom] = reach(y0, y1, camera_y_);
      ceiling = terrain_.HighestIn(left - 1, top - 1, right + 1, bottom + 1);
    }
    return ceiling;
  }

  // (x, y): where the ray meets the ground, texels.
  Hit Cast(float x, float y, float near) const {
    if (near <= 0) return {x, y, 0, false, false};
    // A metre up along the ray.
    const float up_x = (camera_x_ - x) / altitude_;
    const float up_y = (camera_y_ - y) / altitude_;
    const float slope = std::max(std::abs(up_x), std::abs(up_y));
    const float texel_drop = 1 / std::max(slope, 1e-4F);  // height lost while moving one texel
    float above = near;
    for (float z = near; z > 0;) {
      const float u = x + z * up_x;
      const float v = y + z * up_y;
      const float around = terrain_.highest_around(Column(u), Row(v));
      if (z > around) {
        // Nothing within a block is as high: drop to where there may be something.
        above = z;
        z -= std::min(std::max(z - around, texel_drop), Terrain::kBlock * texel_drop);
        continue;
      }
      if (HeightAt(u, v) >= z) return Refine(x, y, up_x, up_y, z, above);
      above = z;
      z -= texel_drop;
    }
    return Refine(x, y, up_x, up_y, 0, above);
  }

  // The direction over the map from a spot, in texels, to the camera: unit length.
  Eigen::Vector2f Away(const Eigen::Vector2f& spot) const {
    const Eigen::Vector2f away(camera_x_ - spot.x(), camera_y_ - spot.y());
    return away / std::max(away.norm(), 1e-3F);
  }

 private:
  Terrain::Height RawAt(float x, float y) const {
    return terrain_.heights()[static_cast<std::size_t>(Row(y)) * terrain_.width() + Column(x)];
  }
  int Column(float x) const {
    return std::clamp(static_cast<int>(x + 0.5F), 0, terrain_.width() - 1);
  }
  int Row(float y) const {
    return std::clamp(static_cast<int>(y + 0.5F), 0, terrain_.height() - 1);
  }
  float HeightAt(float x, float y) const { return Terrain::HeightMetres(RawAt(x, y)); }

  // The ray is under the surface at `below` and over it at `above`.
  Hit Refine(float x, float y, float up_x, float up_y, float below, float above) const {
    for (int i = 0; i < 5; ++i) {
      const float z = 0.5F * (below + above);
      (HeightAt(x + z * up_x, y + z * up_y) >= z ? below : above) = z;
    }
    const float u = x + below * up_x;
    const float v = y + below * up_y;
    const Terrain::Height raw = RawAt(u, v);
    const float surface = Terrain::HeightMetres(raw);
    if (surface <= 0) return {x, y, 0, false, false};
    return {u, v, below, surface - below > 0.35F, (raw & Terrain::kFoliage) != 0};
  }

  const Terrain& terrain_;
  float camera_x_;
  float camera_y_;
  float altitude_;
};

// Bilinear mean of four packed colours, all four bytes at once.
std::uint32_t Sample(const Terrain& terrain, float x, float y) {
  x = std::clamp(x, 0.0F, static_cast<float>(terrain.width()) - 1.01F);
  y = std::clamp(y, 0.0F, static_cast<float>(terrain.height()) - 1.01F);
  const auto column = static_cast<int>(x);
  const auto row = static_cast<int>(y);
  const auto u = static_cast<std::uint32_t>((x - static_cast<float>(column)) * 256 + 0.5F);
  const auto v = static_cast<std::uint32_t>((y - static_cast<float>(row)) * 256 + 0.5F);
  const std::uint32_t* top =
      terrain.colours() + static_cast<std::size_t>(row) * terrain.width() + column;
  const std::uint32_t* bottom = top + terrain.width();
  constexpr std::uint32_t kMask = 0x00FF00FFU;
  constexpr std::uint32_t kHalf = 0x00800080U;
  const auto mix = [](std::uint32_t a, std::uint32_t b, std::uint32_t share) {
    return ((a * (256 - share) + b * share + kHalf) >> 8) & kMask;
  };
  const std::uint32_t even =
      mix(mix(top[0] & kMask, top[1] & kMask, u), mix(bottom[0] & kMask, bottom[1] & kMask, u), v);
  const std::uint32_t odd = mix(mix(top[0] >> 8 & kMask, top[1] >> 8 & kMask, u),
                                mix(bottom[0] >> 8 & kMask, bottom[1] >> 8 & kMask, u), v);
  return even | odd << 8;
}

// The side of a building or a crown, in the colour of its top made darker; buildings have windows.
float WallLight(const Hit& hit, const Terrain& terrain, const Sun& sun,
                const Eigen::Vector2f& away) {
  // The wall looks about where the ray came from.
  const Eigen::Vector2f flat = sun.direction.head<2>().cast<float>();
  const float facing = std::max(0.0F, away.dot(flat));
  const float light = sun.ambient * 1.15F + 0.55F * facing;
  if (hit.foliage) return 0.75F * light;
  const float floor_height = hit.height - 2.8F * std::floor(hit.height / 2.8F);
  const auto texel = static_cast<float>(terrain.texel_m());
  const float along = (hit.x * away.y() - hit.y * away.x()) * texel;
  const float bay = along - 2.6F * std::floor(along / 2.6F);
  const bool window = floor_height > 0.9F && floor_height < 2.2F && bay > 0.7F && bay < 1.9F;
  return window ? 0.45F : light;
}

}  // namespace

View::View(int width, int rows)
    : width_(width), rows_(rows), pixels_(static_cast<std::size_t>(width) * rows) {}

void View::Draw(const Terrain& terrain, const Camera& camera, const Sun& sun,
                const std::vector<DrawnVehicle>& vehicles, int first_row, double shift_x,
                double shift_y) {
  first_row_ = first_row;
  shift_x_ = shift_x;
  shift_y_ = shift_y;
  Eigen::Matrix3d shifted = Eigen::Matrix3d::Identity();
  shifted(0, 2) = shift_x;
  shifted(1, 2) = shift_y;
  rays_ = camera.WorldFromPixel() * shifted;
  DrawTerrain(terrain, sun, camera);
  for (const DrawnVehicle& vehicle : vehicles) DrawShadow(vehicle, sun, camera);
  for (const DrawnVehicle& vehicle : vehicles) {
    for (const Face& face : vehicle.faces) DrawFace(face, vehicle.id, camera);
  }
}

void View::DrawTerrain(const Terrain& terrain, const Sun& sun, const Camera& camera) {
  const RayCaster caster(terrain, camera);
  Eigen::Matrix3d texels;
  texels << camera.altitude_m, 0, camera.x_m - terrain.origin().x(), 0, camera.altitude_m,
      camera.y_m - terrain.origin().y(), 0, 0, terrain.texel_m();
  const Eigen::Matrix3d texel_from_pixel = texels * rays_;
  const auto end_x = static_cast<double>(terrain.width() - 1);
  const auto end_y = static_cast<double>(terrain.height() - 1);
  const auto ground = [&](double x, double row) {
    const Eigen::Vector3d point = texel_from_pixel * Eigen::Vector3d(x, first_row_ + row, 1);
    return Eigen::Vector2f(static_cast<float>(std::clamp(point.x() / point.z(), 0.0, end_x)),
                           static_cast<float>(std::clamp(point.y() / point.z(), 0.0, end_y)));
  };
  // Cell by cell, so that rays over open ground need no look at what stands on it.
  for (int cell_row = 0; cell_row < rows_; cell_row += kCell) {
    for (int cell_x = 0; cell_x < width_; cell_x += kCell) {
      const int end_row = std::min(rows_, cell_row + kCell);
      const int end_column = std::min(width_, cell_x + kCell);
      const Eigen::Vector2f a = ground(cell_x, cell_row);
      const Eigen::Vector2f b = ground(end_column - 1, cell_row);
      const Eigen::Vector2f c = ground(cell_x, end_row - 1);
      const Eigen::Vector2f d = ground(end_column - 1, end_row - 1);
      const Eigen::Vector2f low = a.cwiseMin(b).cwiseMin(c).cwiseMin(d);
      const Eigen::Vector2f high = a.cwiseMax(b).cwiseMax(c).cwiseMax(d);
      const float ceiling = caster.Ceiling(low.x(), low.y(), high.x(), high.y());
      for (int row = cell_row; row < end_row; ++row) {
        for (int x = cell_x; x < end_column; ++x) {
          const Eigen::Vector2f spot = ground(x, row);
          const Hit hit = caster.Cast(spot.x(), spot.y(), ceiling);
          const std::uint32_t colour = Sample(terrain, hit.x, hit.y);
          const float light = hit.wall ? WallLight(hit, terrain, sun, caster.Away(spot)) : 1.0F;
          pixels_[static_cast<std::size_t>(row) * width_ + x] = {
              static_cast<float>(colour & 255) * light,
              static_cast<float>(colour >> 8 & 255) * light,
              static_cast<float>(colour >> 16 & 255) * light,
              hit.height,
              static_cast<float>(colour >> 24) / 255,
              0};
        }
      }
    }
  }
}

void View::DrawShadow(const DrawnVehicle& vehicle, const Sun& sun, const Camera& camera) {
  std::array<Eigen::Vector2d, 6> outline{};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& spot = vehicle.shadow[i];
    outline[i] = camera.Project({spot.x(), spot.y(), 0}) - Eigen::Vector2d(shift_x_, shift_y_);
  }
  ForEachPixelInside(outline, 0, width_, first_row_, first_row_ + rows_, [&](int x, int y) {
    Pixel& pixel = pixels_[static_cast<std::size_t>(y - first_row_) * width_ + x];
    if (pixel.height > 0.2F) return;
    const float light = 1 - pixel.sun * (1 - sun.ambient);
    pixel.blue *= light;
    pixel.green *= light;
    pixel.red *= light;
    pixel.sun = 0;
  });
}

void View::DrawFace(const Face& face, std::int64_t id, const Camera& camera) {
  std::array<Eigen::Vector2d, 4> outline{};
  for (int i = 0; i < 4; ++i) {
    outline[i] = camera.Project(face.corners[i]) - Eigen::Vector2d(shift_x_, shift_y_);
  }
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
    const auto height = static_cast<float>(camera.altitude_m - offset / facing * ray.z());
    Pixel& pixel = pixels_[static_cast<std::size_t>(y - first_row_) * width_ + x];
    if (height < pixel.height) return;
    pixel = {face.colour[0], face.colour[1], face.colour[2], height, pixel.sun, id};
  });
}

}  // namespace windhover::replay
