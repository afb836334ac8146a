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
// A step of this many metres between neighbouring texels is a wall, not a slope; where texels are
// large, so is a slope of more than kSteepest.
constexpr float kWall = 0.45F;
constexpr float kSteepest = 1.3F;

int Below(int value) { return value & ~(Terrain::kAlignment - 1); }
int Above(int value) { return Below(value + Terrain::kAlignment - 1); }

constexpr int kShadowLevel = 2;  // of the blocks that shadows are looked for in
constexpr int kShadowBlock = 1 << (Terrain::kBlockShift * kShadowLevel);

// Whole steps along one axis before a ray leaves the block around `i`.
int StepsToEdge(int i, float step, float per_step) {
  const int inside = i & (kShadowBlock - 1);
  const int way = step > 0 ? kShadowBlock - 1 - inside : inside;
  return static_cast<int>(std::min(static_cast<float>(way) * per_step, 64.0F));
}

// The way of the sun's light over a raster, in steps of a texel.
struct SunWay {
  explicit SunWay(const Eigen::Vector3d& direction, double texel_m) {
    const Eigen::Vector3f sun = direction.cast<float>();
    const float flat = std::max(1e-3F, std::sqrt(sun.x() * sun.x() + sun.y() * sun.y()));
    x = sun.x() / flat;
    y = sun.y() / flat;
    per_x = 1 / std::max(std::abs(x), 1e-6F);
    per_y = 1 / std::max(std::abs(y), 1e-6F);
    rise = static_cast<float>(texel_m) * sun.z() / flat;
  }
  float x;
  float y;
  float per_x;
  float per_y;
  float rise;  // m a step
};

}  // namespace

Terrain::Terrain(const Scene& scene, const GroundPhoto* photo, const TexelRect& rect,
                 double texel_m, int threads, const std::function<void()>& go_on)
    : rect_{Below(rect.x0), Below(rect.y0), Above(rect.x1), Above(rect.y1)},
      texel_m_(texel_m),
      heights_(rect_.area()),
      surfaces_(rect_.area()),
      undersides_(rect_.area()) {
  colours_[0].resize(rect_.area());
  const std::function<void()> check = go_on ? go_on : [] {};
  Paint(scene, photo, threads, check);
  FindHighest();
  Light(scene, threads, check);
  MakeMips(threads);
}

void Terrain::Paint(const Scene& scene, const GroundPhoto* photo, int threads,
                    const std::function<void()>& go_on) {
  ForEachInParallel((height() + kStripRows - 1) / kStripRows, threads, [&](int i) {
    go_on();
    const int row = i * kStripRows;
    const std::size_t first = static_cast<std::size_t>(row) * width();
    const Strip strip = {texel_m_,
                         width(),
                         std::min(kStripRows, height() - row),
                         rect_.x0,
                         rect_.y0 + row,
                         colours_[0].data() + first,
                         heights_.data() + first,
                         surfaces_.data() + first,
                         undersides_.data() + first};
    PaintGround(scene, photo, strip);
    PaintObjects(scene, strip);
  });
}

void Terrain::FindHighest() {
  const Height* below = heights_.data();
  int below_width = width();
  for (int level = 1; level <= kBlockLevels; ++level) {
    const int columns = block_width(level);
    const int rows = height() >> (kBlockShift * level);
    std::vector<Height>& blocks = highest_[level - 1];
    blocks.assign(static_cast<std::size_t>(columns) * rows, 0);
    for (int y = 0; y < rows << kBlockShift; ++y) {
      const Height* in = below + static_cast<std::size_t>(y) * below_width;
      Height* out = blocks.data() + static_cast<std::size_t>(y >> kBlockShift) * columns;
      for (int x = 0; x < columns << kBlockShift; ++x) {
        out[x >> kBlockShift] = std::max(out[x >> kBlockShift], in[x]);
      }
    }
    below = blocks.data();
    below_width = columns;
  }
  const std::vector<Height>& largest = highest_.back();
  highest_of_all_ = HeightMetres(*std::max_element(largest.begin(), largest.end()));
}

bool Terrain::MayExceed(double x0, double y0, double x1, double y1, double metres) const {
  constexpr int kMostBlocks = 3;  // to a side
  const auto texel = [](double at, int end) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(end - 1)));
  };
  const int left = texel(x0, width());
  const int right = texel(x1, width());
  const int top = texel(y0, height());
  const int bottom = texel(y1, height());
  int level = 1;
  while (level < kBlockLevels &&
         std::max(right - left, bottom - top) >> (kBlockShift * level) > kMostBlocks) {
    ++level;
  }
  const int shift = kBlockShift * level;
  for (int y = top >> shift; y <= bottom >> shift; ++y) {
    const Height* row = highest(level) + static_cast<std::size_t>(y) * block_width(level);
    for (int x = left >> shift; x <= right >> shift; ++x) {
      if (HeightMetres(row[x]) > metres) return true;
    }
  }
  return false;
}

bool Terrain::MayBeShaded(int block_x, int block_y, float step_x, float step_y, float rise) const {
  const int columns = block_width(kShadowLevel);
  const int rows = height() / kShadowBlock;
  const auto reach = static_cast<int>(highest_of_all_ / (rise * kShadowBlock)) + 2;
  for (int ahead = 0; ahead <= reach; ++ahead) {
    const int x = block_x + static_cast<int>(std::floor(static_cast<float>(ahead) * step_x + 0.5F));
    const int y = block_y + static_cast<int>(std::floor(static_cast<float>(ahead) * step_y + 0.5F));
    // Blocks around that the light may come through, and what they hide at least so far away.
    const float ray = rise * kShadowBlock * static_cast<float>(std::max(0, ahead - 2));
    for (int v = std::max(0, y - 1); v <= std::min(rows - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(columns - 1, x + 1); ++u) {
        const Height top = highest_[kShadowLevel - 1][static_cast<std::size_t>(v) * columns + u];
        if (HeightMetres(top) > ray) return true;
      }
    }
  }
  return false;
}

// Shadows from everything between a spot and the sun.
void Terrain::Light(const Scene& scene, int threads, const std::function<void()>& go_on) {
  const SunWay way(scene.sun.direction, texel_m_);
  const auto in_sun = [&](int x, int y) {
    const std::size_t own = static_cast<std::size_t>(y) * width() + x;
    const float start = HeightMetres(heights_[own]) + 0.05F;
    for (float steps = 1.5F;;) {
      const auto u = static_cast<int>(static_cast<float>(x) + steps * way.x + 0.5F);
      const auto v = static_cast<int>(static_cast<float>(y) + steps * way.y + 0.5F);
      const float ray = start + steps * way.rise;
      if (ray > highest_of_all_ || u < 0 || v < 0 || u >= width() || v >= height()) return true;
      const std::size_t block =
          static_cast<std::size_t>(v / kShadowBlock) * block_width(kShadowLevel) + u / kShadowBlock;
      if (HeightMetres(highest_[kShadowLevel - 1][block]) < ray) {
        steps += static_cast<float>(
            1 + std::min(StepsToEdge(u, way.x, way.per_x), StepsToEdge(v, way.y, way.per_y)));
        continue;
      }
      const std::size_t there = static_cast<std::size_t>(v) * width() + u;
      if (HeightMetres(heights_[there]) > ray &&
          static_cast<float>(undersides_[there]) * kUndersideUnit <= ray) {
        return false;
      }
      steps += 1;
    }
  };
  std::vector<std::uint8_t> lit(rect_.area(), 1);
  ForEachInParallel(height() / kShadowBlock, threads, [&](int block_y) {
    go_on();
    for (int block_x = 0; block_x < block_width(kShadowLevel); ++block_x) {
      if (!MayBeShaded(block_x, block_y, way.x, way.y, way.rise)) continue;
      for (int y = block_y * kShadowBlock; y < (block_y + 1) * kShadowBlock; ++y) {
        for (int x = block_x * kShadowBlock; x < (block_x + 1) * kShadowBlock; ++x) {
          lit[static_cast<std::size_t>(y) * width() + x] = in_sun(x, y) ? 1 : 0;
        }
      }
    }
  });
  ForEachInParallel(height(), threads, [&](int y) { LightRow(scene, y, lit); });
}

// Lambert's law on the surface's slopes.
void Terrain::LightRow(const Scene& scene, int y, const std::vector<std::uint8_t>& lit) {
  const Eigen::Vector3f sun = scene.sun.direction.cast<float>();
  const float ambient = scene.sun.ambient;
  const auto texel = static_cast<float>(texel_m_);
  const float wall = std::max(kWall, 2 * texel * kSteepest);
  const auto height_at = [this](int x, int row) {
    return HeightMetres(heights_[static_cast<std::size_t>(row) * width() + x]);
  };
  const auto slope = [texel, wall](float low, float high) {
    const float rise = high - low;
    return std::abs(rise) > wall ? 0.0F : rise / (2 * texel);
  };
  for (int x = 0; x < width(); ++x) {
    const std::size_t i = static_cast<std::size_t>(y) * width() + x;
    // The sun is half a degree wide and the air scatters: shadows have soft edges.
    int sum = 0;
    for (int v = std::max(0, y - 1); v <= std::min(height() - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width() - 1, x + 1); ++u) {
        sum += lit[static_cast<std::size_t>(v) * width() + u];
      }
    }
    const float share = static_cast<float>(sum) / 9;
    float facing = 1.0F;
    if (x > 0 && y > 0 && x + 1 < width() && y + 1 < height()) {
      const float dx = slope(height_at(x - 1, y), height_at(x + 1, y));
      const float dy = slope(height_at(x, y - 1), height_at(x, y + 1));
      facing = std::max(0.0F, sun.z() - dx * sun.x() - dy * sun.y()) /
               (sun.z() * std::sqrt(1 + dx * dx + dy * dy));
    }
    const float light = ambient + (1 - ambient) * share * std::min(facing, 1.5F);
    const std::uint32_t colour = colours_[0][i];
    // Shade is lit by the sky: a little bluer than the sun.
    const float blue = light + 0.05F * (1 - share);
    colours_[0][i] =
        Pack(static_cast<float>(colour & 255) * blue, static_cast<float>(colour >> 8 & 255) * light,
             static_cast<float>(colour >> 16 & 255) * light, 255 * share);
  }
}

void Terrain::MakeMips(int threads) {
  constexpr std::uint32_t kMask = 0x00FF00FFU;
  constexpr std::uint32_t kHalf = 0x00020002U;
  for (int mip = 1; mip <= kMips; ++mip) {
    const int columns = width() >> mip;
    const int rows = height() >> mip;
    colours_[mip].resize(static_cast<std::size_t>(columns) * rows);
    ForEachInParallel(rows, threads, [&, mip, columns](int y) {
      const std::uint32_t* top =
          colours_[mip - 1].data() + static_cast<std::size_t>(2 * y) * 2 * columns;
      const std::uint32_t* bottom = top + 2 * static_cast<std::ptrdiff_t>(columns);
      std::uint32_t* out = colours_[mip].data() + static_cast<std::size_t>(y) * columns;
      for (int x = 0; x < columns; ++x) {
        const auto mean = [&](int shift) {
          const std::uint32_t sum =
              (top[2 * x] >> shift & kMask) + (top[2 * x + 1] >> shift & kMask) +
              (bottom[2 * x] >> shift & kMask) + (bottom[2 * x + 1] >> shift & kMask);
          return (sum + kHalf) >> 2 & kMask;
        };
        out[x] = mean(0) | mean(8) << 8;
      }
    });
  }
}

float Terrain::SunAt(const Eigen::Vector2d& spot) const {
  const int x = static_cast<int>(std::floor(spot.x() / texel_m_ + 0.5)) - rect_.x0;
  const int y = static_cast<int>(std::floor(spot.y() / texel_m_ + 0.5)) - rect_.y0;
  if (x < 0 || y < 0 || x >= width() || y >= height()) return 1.0F;
  return static_cast<float>(colours_[0][static_cast<std::size_t>(y) * width() + x] >> 24) / 255;
}

}  // namespace windhover::replay
