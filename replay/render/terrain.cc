// SPDX-License-Identifier: Apache-2.0
#include "replay/render/terrain.h"

#include <algorithm>
#include <cmath>

#include "replay/render/ground_painter.h"
#include "replay/render/painting.h"
#include "replay/render/parallel.h"

namespace windhover::replay {
namespace {

constexpr int kStripRows = 64;
// A step of this many metres between neighbouring texels is a wall, not a slope.
constexpr float kWall = 0.45F;

// Whole steps that a ray can go along one axis before it leaves the block of texel `i`.
float StepsToEdge(int i, float step) {
  const int inside = i % Terrain::kBlock;
  const float way = static_cast<float>(step > 0 ? Terrain::kBlock - 1 - inside : inside);
  return std::floor(std::min(way / std::max(std::abs(step), 1e-6F), 64.0F));
}

int Ceiling(double value) { return static_cast<int>(std::ceil(value)); }

}  // namespace

Terrain::Terrain(const Scene& scene, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                 double texel_m, int threads, const std::function<void()>& go_on)
    : origin_(low),
      texel_m_(texel_m),
      width_(Ceiling((high.x() - low.x()) / texel_m) + 2),
      height_(Ceiling((high.y() - low.y()) / texel_m) + 2),
      blocks_x_((width_ + kBlock - 1) / kBlock),
      blocks_y_((height_ + kBlock - 1) / kBlock),
      colours_(static_cast<std::size_t>(width_) * height_),
      heights_(colours_.size()),
      highest_(static_cast<std::size_t>(blocks_x_) * blocks_y_),
      highest_around_(highest_.size()) {
  const std::function<void()> check = go_on ? go_on : [] {};
  Paint(scene, threads, check);
  FindHighest();
  Light(scene, threads, check);
}

void Terrain::Paint(const Scene& scene, int threads, const std::function<void()>& go_on) {
  ForEachInParallel((height_ + kStripRows - 1) / kStripRows, threads, [&](int i) {
    go_on();
    const int row = i * kStripRows;
    const std::size_t first = static_cast<std::size_t>(row) * width_;
    const Strip strip = {origin_,
                         texel_m_,
                         width_,
                         row,
                         std::min(kStripRows, height_ - row),
                         colours_.data() + first,
                         heights_.data() + first};
    PaintGround(scene, strip);
    PaintObjects(scene, strip);
  });
}

void Terrain::FindHighest() {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      float& block = highest_[static_cast<std::size_t>(y / kBlock) * blocks_x_ + x / kBlock];
      block = std::max(block, HeightMetres(heights_[static_cast<std::size_t>(y) * width_ + x]));
    }
  }
  highest_of_all_ = *std::max_element(highest_.begin(), highest_.end());
  for (int y = 0; y < blocks_y_; ++y) {
    for (int x = 0; x < blocks_x_; ++x) {
      float& around = highest_around_[static_cast<std::size_t>(y) * blocks_x_ + x];
      for (int v = std::max(0, y - 1); v <= std::min(blocks_y_ - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(blocks_x_ - 1, x + 1); ++u) {
          around = std::max(around, highest_[static_cast<std::size_t>(v) * blocks_x_ + u]);
        }
      }
    }
  }
}

float Terrain::HighestIn(float x0, float y0, float x1, float y1) const {
  const auto block = [](float texel, int end) {
    return std::clamp(static_cast<int>(std::floor((texel + 0.5F) / kBlock)), 0, end - 1);
  };
  float highest = 0;
  for (int y = block(y0, blocks_y_); y <= block(y1, blocks_y_); ++y) {
    for (int x = block(x0, blocks_x_); x <= block(x1, blocks_x_); ++x) {
      highest = std::max(highest, highest_[static_cast<std::size_t>(y) * blocks_x_ + x]);
    }
  }
  return highest;
}

// Lambert's law on the surface's slopes, and shadows from everything between a spot and the sun.
void Terrain::Light(const Scene& scene, int threads, const std::function<void()>& go_on) {
  const Eigen::Vector3f sun = scene.sun.direction.cast<float>();
  const float sun_slope = sun.z() / std::sqrt(sun.x() * sun.x() + sun.y() * sun.y());
  const float step_x = sun.x() / std::sqrt(sun.x() * sun.x() + sun.y() * sun.y());
  const float step_y = sun.y() / std::sqrt(sun.x() * sun.x() + sun.y() * sun.y());
  const auto texel = static_cast<float>(texel_m_);
  const auto height_at = [this](int x, int y) {
    return HeightMetres(heights_[static_cast<std::size_t>(y) * width_ + x]);
  };
  const auto in_sun = [&](int x, int y) {
    const float start = height_at(x, y) + 0.05F;
    for (float steps = 1.5F;;) {
      const auto u = static_cast<int>(static_cast<float>(x) + steps * step_x + 0.5F);
      const auto v = static_cast<int>(static_cast<float>(y) + steps * step_y + 0.5F);
      const float ray = start + steps * texel * sun_slope;
      if (ray > highest_of_all_ || u < 0 || v < 0 || u >= width_ || v >= height_) return 1.0F;
      if (highest_[static_cast<std::size_t>(v / kBlock) * blocks_x_ + u / kBlock] < ray) {
        steps += 1 + std::min(StepsToEdge(u, step_x), StepsToEdge(v, step_y));
        continue;
      }
      if (height_at(u, v) > ray) return 0.0F;
      steps += 1;
    }
  };
  std::vector<std::uint8_t> lit(colours_.size(), 255);
  ForEachInParallel(height_, threads, [&](int y) {
    go_on();
    for (int x = 0; x < width_; ++x) {
      lit[static_cast<std::size_t>(y) * width_ + x] = in_sun(x, y) > 0 ? 255 : 0;
    }
  });
  ForEachInParallel(height_, threads, [&](int y) {
    go_on();
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width_ + x;
      // The sun is half a degree wide and the air scatters: shadows have soft edges.
      int sum = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) {
          sum += lit[static_cast<std::size_t>(v) * width_ + u];
        }
      }
      const float share = static_cast<float>(sum) / (9 * 255);
      const auto slope = [&](float low, float high) {
        const float rise = high - low;
        return std::abs(rise) > kWall ? 0.0F : rise / (2 * texel);
      };
      float facing = 1.0F;
      if (x > 0 && y > 0 && x + 1 < width_ && y + 1 < height_) {
        const float dx = slope(height_at(x - 1, y), height_at(x + 1, y));
        const float dy = slope(height_at(x, y - 1), height_at(x, y + 1));
        facing = std::max(0.0F, sun.z() - dx * sun.x() - dy * sun.y()) /
                 (sun.z() * std::sqrt(1 + dx * dx + dy * dy));
      }
      const float ambient = scene.sun.ambient;
      const float light = ambient + (1 - ambient) * share * std::min(facing, 1.5F);
      const std::uint32_t colour = colours_[i];
      // Shade is lit by the sky: a little bluer than the sun.
      const float blue = light + 0.05F * (1 - share);
      colours_[i] = Pack(static_cast<float>(colour & 255) * blue,
                         static_cast<float>(colour >> 8 & 255) * light,
                         static_cast<float>(colour >> 16 & 255) * light, 255 * share);
    }
  });
}

float Terrain::SunAt(const Eigen::Vector2d& spot) const {
  const Eigen::Vector2d texel = (spot - origin_) / texel_m_;
  const auto x = static_cast<int>(std::floor(texel.x() + 0.5));
  const auto y = static_cast<int>(std::floor(texel.y() + 0.5));
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return 1.0F;
  return static_cast<float>(colours_[static_cast<std::size_t>(y) * width_ + x] >> 24) / 255;
}

}  // namespace windhover::replay
