// SPDX-License-Identifier: Apache-2.0
#include "replay/render/shading.h"

#include <algorithm>
#include <cmath>

#include "replay/render/painting.h"

namespace windhover::replay {
namespace {

// Bilinear mean of four packed colours, all four bytes at once; shares in 256ths.
std::uint32_t Mixed(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                    std::uint32_t u, std::uint32_t v) {
  constexpr std::uint32_t kMask = 0x00FF00FFU;
  constexpr std::uint32_t kHalf = 0x00800080U;
  const auto mix = [](std::uint32_t first, std::uint32_t second, std::uint32_t share) {
    return ((first * (256 - share) + second * share + kHalf) >> 8) & kMask;
  };
  const auto pair = [&](int shift) {
    return mix(mix(a >> shift & kMask, b >> shift & kMask, u),
               mix(c >> shift & kMask, d >> shift & kMask, u), v);
  };
  return pair(0) | pair(8) << 8;
}

Colour Scaled(const Colour& colour, float light) {
  return {colour[0] * light, colour[1] * light, colour[2] * light};
}

bool InRange(float value, float low, float high) { return value > low && value < high; }

// Unlit colour of a wall `along` it and over the ground, m.
Colour FacadeAt(const Facade& facade, float along, float height, std::uint32_t seed) {
  constexpr Colour kPane = {74, 66, 58};
  const float storey = std::floor(height / facade.floor);
  const float up = height - storey * facade.floor;
  const float column = std::floor(along / facade.bay);
  const float side = along - column * facade.bay;
  const float pick = Noise(column * 1.37F + 0.5F, storey * 1.71F + 0.5F, seed);
  const float dirt = 1 + 0.10F * Noise(along / 2.7F, height / 4.1F, seed + 1);
  const Colour wall = Scaled(facade.colour, dirt);
  // Panes show sky, curtains or the dark of the room.
  const Colour pane = pick > 0.3F ? Colour{176, 164, 150} : Scaled(kPane, 1 + 0.7F * pick);
  switch (facade.kind) {
    case FacadeKind::kBlank:
      return wall;
    case FacadeKind::kPlaster: {
      const bool window =
          InRange(up, 0.9F, 2.2F) && InRange(side, 0.27F * facade.bay, 0.73F * facade.bay);
      return window ? pane : wall;
    }
    case FacadeKind::kBalconies: {
      if (up < 1.05F && Wrapped(column, 3) < 2) return Scaled(facade.colour, 1.12F);
      const bool window = InRange(up, 0.3F, 2.4F) && InRange(side, 0.4F, facade.bay - 0.5F);
      return window ? Scaled(pane, 0.8F) : wall;
    }
    case FacadeKind::kBands:
      return InRange(up, 0.9F, 2.3F) && side > 0.12F ? pane : wall;
    case FacadeKind::kGlass: {
      if (side < 0.14F || up < 0.22F) return Scaled(facade.colour, 0.6F);
      const float tilt = 0.85F + 0.3F * pick + 0.004F * height;
      return Scaled(facade.colour, tilt);
    }
  }
  return wall;
}

}  // namespace

Shading::Shading(const Scene& scene, const Terrain& terrain, double time_s)
    : scene_(scene),
      terrain_(terrain),
      time_s_(time_s),
      sun_height_(static_cast<float>(scene.sun.direction.z())) {}

// (x, y) on the lattice, where texel i reaches from i to i + 1.
Shading::Light Shading::Sampled(double x, double y, int mip) const {
  const double scale = 1.0 / (1 << mip);
  const double u = x * scale - 0.5;
  const double v = y * scale - 0.5;
  const int column = Floor(u);
  const int row = Floor(v);
  const int last_x = (terrain_.width() >> mip) - 1;
  const int last_y = (terrain_.height() >> mip) - 1;
  const int i = column - (terrain_.rect().x0 >> mip);
  const int j = row - (terrain_.rect().y0 >> mip);
  const int left = std::clamp(i, 0, last_x);
  const int right = std::clamp(i + 1, 0, last_x);
  const std::uint32_t* colours = terrain_.colours(mip);
  const std::uint32_t* top =
      colours + static_cast<std::size_t>(std::clamp(j, 0, last_y)) * (last_x + 1);
  const std::uint32_t* bottom =
      colours + static_cast<std::size_t>(std::clamp(j + 1, 0, last_y)) * (last_x + 1);
  const std::uint32_t colour = Mixed(top[left], top[right], bottom[left], bottom[right],
                                     static_cast<std::uint32_t>((u - column) * 256),
                                     static_cast<std::uint32_t>((v - row) * 256));
  return {{static_cast<float>(colour & 255), static_cast<float>(colour >> 8 & 255),
           static_cast<float>(colour >> 16 & 255)},
          static_cast<float>(colour >> 24) * (1.0F / 255)};
}

Shading::Light Shading::At(const Hit& hit, const Eigen::Vector3d& ray, double footprint_m) const {
  if (hit.kind == Hit::Kind::kBeneath) return Beneath(hit);
  if (hit.kind == Hit::Kind::kWall) return Wall(hit, ray);
  // Several rays make a pixel: each stands for about half of it.
  int mip = 0;
  for (double texels = 0.35 * footprint_m / terrain_.texel_m(); texels > 1 && mip < Terrain::kMips;
       texels *= 0.5) {
    ++mip;
  }
  const Terrain::Surface surface = terrain_.surfaces()[hit.texel];
  if (surface == Terrain::kWater) return Water(hit, Sampled(hit.x, hit.y, mip));
  double x = hit.x;
  double y = hit.y;
  if (surface == Terrain::kFoliage && scene_.wind.sway_m > 0) {
    // Gusts run over the leaves; each part of a crown swings in its own time.
    const double texel = terrain_.texel_m();
    const double phase = 0.9 * x * texel + 0.7 * y * texel;
    const double swing = Sine(4.4 * time_s_ - 0.35 * phase) + 0.6 * Sine(7.3 * time_s_ + phase);
    const double size = scene_.wind.sway_m * std::min(1.0, 0.15 * hit.height) / texel;
    x += size * swing * scene_.wind.direction.x();
    y += size * swing * scene_.wind.direction.y();
  }
  return Sampled(x, y, mip);
}

bool Shading::InSun(const Eigen::Vector2d& spot, double height) const {
  const RayCaster caster(terrain_, spot, height);
  const Eigen::Vector3d& sun = scene_.sun.direction;
  const Eigen::Vector3d way(sun.x(), sun.y(), -sun.z());
  return caster.Cast(way, 0, 1e4).kind == Hit::Kind::kNone;
}

Shading::Light Shading::BuildingWall(const Hit& hit, const Building& building,
                                     std::uint32_t seed) const {
  const double texel = terrain_.texel_m();
  const Eigen::Vector2d spot((hit.x - 0.5) * texel, (hit.y - 0.5) * texel);
  const Eigen::Vector2d& forward = building.area.forward;
  const Eigen::Vector2d from = spot - building.area.centre;
  const double along = from.dot(forward);
  const double across = from.dot(Right(forward));
  // The nearest of the four walls.
  const bool end =
      0.5 * building.area.length - std::abs(along) < 0.5 * building.area.width - std::abs(across);
  const Eigen::Vector2d normal =
      end ? (along > 0 ? 1.0 : -1.0) * forward : (across > 0 ? 1.0 : -1.0) * Right(forward);
  const double facing = normal.dot(scene_.sun.direction.head<2>());
  float sun = 0;
  if (facing > 0 && InSun(spot + 1.6 * texel * normal, hit.height)) {
    sun = std::min(1.25F, static_cast<float>(facing) / sun_height_);
  }
  const float ambient = scene_.sun.ambient;
  // A wall sees half of the sky and some of the lit ground.
  const float light = 0.85F * ambient + (1 - ambient) * sun;
  const auto way = static_cast<float>((end ? across : along) + 500);
  const Colour colour = FacadeAt(building.facade, way, hit.height, seed);
  return {{colour[0] * (light + (sun > 0 ? 0 : 0.04F)), colour[1] * light, colour[2] * light},
          sun > 0 ? 1.0F : 0.0F};
}

Shading::Light Shading::Wall(const Hit& hit, const Eigen::Vector3d& ray) const {
  const Terrain::Surface surface = terrain_.surfaces()[hit.texel];
  if (surface >= Terrain::kFirstBuilding) {
    const std::size_t index = surface - Terrain::kFirstBuilding;
    return BuildingWall(hit, scene_.buildings[index],
                        static_cast<std::uint32_t>(scene_.seed + 7919 * index));
  }
  Light light = Sampled(hit.x, hit.y, 0);
  // The side looks about where the ray comes from.
  const Eigen::Vector2d away = -ray.head<2>() / std::max(1e-9, ray.head<2>().norm());
  const float facing = std::max(0.0F, static_cast<float>(away.dot(scene_.sun.direction.head<2>())));
  float side = scene_.sun.ambient + 0.5F * facing;
  if (surface == Terrain::kTrunk) light.colour = {46, 58, 68};
  if (surface == Terrain::kFoliage) {
    // Lower leaves hang in the shade of upper ones.
    const float top = Terrain::HeightMetres(terrain_.heights()[hit.texel]);
    const float depth = 1 - hit.height / std::max(top, 0.1F);
    const auto x = static_cast<float>(hit.x * terrain_.texel_m());
    const auto y = static_cast<float>(hit.y * terrain_.texel_m());
    side = (0.9F * side + 0.1F) * (1 - 0.45F * depth) *
           (1 + 0.3F * Noise((x + y) / 0.5F, hit.height / 0.5F, 5));
  }
  light.colour = Scaled(light.colour, side);
  return light;
}

// Ground in the shade of what hangs over it.
Shading::Light Shading::Beneath(const Hit& hit) const {
  const auto x = static_cast<float>(hit.x * terrain_.texel_m());
  const auto y = static_cast<float>(hit.y * terrain_.texel_m());
  const bool leaves = terrain_.surfaces()[hit.texel] == Terrain::kFoliage;
  const Colour colour = leaves ? Colour{44, 66, 62} : Colour{104, 104, 103};
  const float light = scene_.sun.ambient * (1 + 0.2F * Texture(x, y, 4, 0.9F, 0.3F, 77));
  return {Scaled(colour, light), 0};
}

// Small waves mirror more or less of the sky, and the sun where they are inclined to it.
Shading::Light Shading::Water(const Hit& hit, Light light) const {
  const auto x = static_cast<float>(hit.x * terrain_.texel_m());
  const auto y = static_cast<float>(hit.y * terrain_.texel_m());
  const auto t = static_cast<float>(time_s_);
  const float swell = Noise(x / 2.3F + 0.8F * t, y / 1.7F - 0.5F * t, 91);
  const float chop = Noise(x / 0.55F + 2.6F * t, y / 0.7F + 1.1F * t, 92);
  const float fine = Noise(x / 0.31F - 6.3F * t, y / 0.27F + 7.1F * t, 93);
  const float glint = std::max(0.0F, 0.45F * swell + 0.6F * chop + 0.75F * fine - 0.72F);
  const float wave = 1 + 0.10F * swell + 0.08F * chop;
  for (float& channel : light.colour) {
    channel = std::min(255.0F, channel * wave + 900 * scene_.glint * glint * light.sun);
  }
  return light;
}

Colour SkyColour(const Sky& sky, const Eigen::Vector3d& ray, std::uint64_t seed) {
  const auto up = static_cast<float>(-ray.z() / ray.norm());
  const float share = std::clamp(up / 0.55F, 0.0F, 1.0F);
  Colour colour = Between(sky.horizon, sky.zenith, std::sqrt(share));
  if (up <= 0.01F || sky.clouds <= 0) return colour;
  // A sheet of clouds far above, that fades towards the horizon.
  const auto x = static_cast<float>(ray.x() / -ray.z());
  const auto y = static_cast<float>(ray.y() / -ray.z());
  const auto key = static_cast<std::uint32_t>(seed) * 17U;
  float sum = 0;
  float weight = 0.5F;
  float scale = 0.7F;
  for (std::uint32_t i = 0; i < 5; ++i) {
    sum += weight * Noise(x * scale, y * scale, key + i);
    weight *= 0.5F;
    scale *= 2.1F;
  }
  const float cover = std::clamp((sum + 1.1F * sky.clouds - 0.45F) * 2.2F, 0.0F, 1.0F);
  const float near = std::clamp(up * 9, 0.0F, 1.0F);
  const Colour cloud =
      Between({214, 210, 206}, {246, 245, 244}, std::clamp(0.5F + sum, 0.0F, 1.0F));
  return Between(colour, cloud, 0.85F * cover * near);
}

float HazeShare(const Sky& sky, double distance_m) {
  // 1 - exp(-x) by a series of its inverse: the same on every machine.
  const auto x = static_cast<float>(std::min(distance_m / sky.haze_m, 20.0));
  return 1 - 1 / (1 + x * (1 + x * 0.5F * (1 + x * 0.3333F * (1 + x * 0.25F * (1 + x * 0.2F)))));
}

}  // namespace windhover::replay
