// SPDX-License-Identifier: Apache-2.0
#include "service/vision/forward_backward.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

constexpr int kRadius = 4;
constexpr int kSide = 2 * kRadius + 1;
constexpr int kArea = kSide * kSide;
constexpr int kMaxCellPx = ForwardBackwardFilter::kMaxCellPx;
constexpr int kMaxAcross = (kSide + 2) * kMaxCellPx;
// Distances from the centre frame at which a pattern is looked for, frames. Few and near: what
// walks changes its looks.
constexpr std::array<int, ForwardBackwardFilter::kSteps> kStepFrames = {1, 3};
constexpr int kIterations = 12;
constexpr float kConverged = 0.02F;
// Further from the expected place a pattern is not looked for, cells.
constexpr float kMaxCorrection = 4.0F;
// Smallest eigenvalue of the patch's mean gradient tensor, (grey levels / px)^2, with which it can
// be followed at all.
constexpr float kMinTexture = ForwardBackwardFilter::kMinTexture;

// Samples a square of `side` x `side` cells around `at`; a cell is the mean of cell_px x cell_px
// bilinear samples one pixel apart. False where that needs pixels that are unseen or outside.
WINDHOVER_MULTIVERSION
bool Sample(const GrayView& image, const Eigen::Vector2f& at, int side, int cell_px, float* out) {
  const int across = side * cell_px;
  const float half = 0.5F * static_cast<float>(across - 1);
  const float left = at.x() - half;
  const float top = at.y() - half;
  if (!(left >= 0 && top >= 0) || left + static_cast<float>(across) > image.width - 1.0F ||
      top + static_cast<float>(across) > image.height - 1.0F) {
    return false;
  }
  const int x = static_cast<int>(left);
  const int y = static_cast<int>(top);
  const float scale = 1.0F / static_cast<float>(cell_px * cell_px);
  const float fx = left - static_cast<float>(x);
  const float fy = top - static_cast<float>(y);
  const float w00 = (1 - fx) * (1 - fy) * scale;
  const float w01 = fx * (1 - fy) * scale;
  const float w10 = (1 - fx) * fy * scale;
  const float w11 = fx * fy * scale;
  int smallest = 255;
  if (cell_px > 1) std::fill_n(out, side * side, 0.0F);
  std::array<float, kMaxAcross> line;
  for (int j = 0; j < across; ++j) {
    const std::uint8_t* upper = image.row(y + j) + x;
    const std::uint8_t* lower = upper + image.stride;
    float* to = cell_px == 1 ? out + j * side : line.data();
    for (int i = 0; i < across; ++i) {
      smallest = std::min<int>(smallest, upper[i]);
      to[i] = w00 * static_cast<float>(upper[i]) + w01 * static_cast<float>(upper[i + 1]) +
              w10 * static_cast<float>(lower[i]) + w11 * static_cast<float>(lower[i + 1]);
    }
    if (fx > 0) smallest = std::min<int>(smallest, upper[across]);
    if (cell_px == 1) continue;
    float* cells = out + j / cell_px * side;
    for (int i = 0; i < side; ++i) {
      for (int k = 0; k < cell_px; ++k) cells[i] += line[i * cell_px + k];
    }
  }
  if (fy > 0) {
    const std::uint8_t* last = image.row(y + across) + x;
    smallest = std::min<int>(smallest, *std::min_element(last, last + across + (fx > 0 ? 1 : 0)));
  }
  return smallest > 0;
}

// The cells of a pattern, and zeros up to a whole number of lanes.
constexpr int kLanes = 16;
constexpr int kPadded = (kArea + kLanes - 1) / kLanes * kLanes;
using Patch = std::array<float, kPadded>;

struct Pattern {
  Patch value{};
  // Gradients with their weighted mean taken out, times the weights.
  Patch dx{};
  Patch dy{};
  Eigen::Matrix2f inverse_tensor;
  float texture = 0;
};

enum class Found { kYes, kNo, kUnseen };

// Sets the weights of a pattern's cells: 1 on seeds and next to them, 0 elsewhere.
void WeighBySeeds(const BitView& seeds, const Eigen::Vector2f& at, int cell_px, float* weight) {
  const int reach = (cell_px + 1) / 2;
  const int left = static_cast<int>(std::lround(at.x())) - kRadius * cell_px - reach;
  const int middle = static_cast<int>(std::lround(at.y()));
  for (int j = 0; j < kSide; ++j) {
    const int y = middle + (j - kRadius) * cell_px;
    std::uint64_t any = 0;
    for (int dy = -reach; dy <= reach; ++dy) any |= seeds.Read(left, y + dy);
    std::uint64_t near = any;
    for (int dx = 1; dx <= 2 * reach; ++dx) near |= any >> dx;
    for (int i = 0; i < kSide; ++i) {
      weight[j * kSide + i] = static_cast<float>(near >> (i * cell_px) & 1);
    }
  }
}

Found TakePattern(const WindowSample& sample, const Eigen::Vector2f& at, int cell_px,
                  Pattern& pattern) {
  constexpr int kWide = kSide + 2;
  std::array<float, kWide * kWide> wide;
  pattern.texture = 0;
  if (!Sample(sample.registered, at, kWide, cell_px, wide.data())) return Found::kUnseen;
  std::array<float, kArea> weight;
  WeighBySeeds(sample.seeds, at, cell_px, weight.data());
  float sum = 0;
  float sum_x = 0;
  float sum_y = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const int to = j * kSide + i;
      const float* p = &wide[(j + 1) * kWide + i + 1];
      pattern.value[to] = *p;
      pattern.dx[to] = 0.5F * (p[1] - p[-1]);
      pattern.dy[to] = 0.5F * (p[kWide] - p[-kWide]);
      sum += weight[to];
      sum_x += weight[to] * pattern.dx[to];
      sum_y += weight[to] * pattern.dy[to];
    }
  }
  if (sum == 0) return Found::kNo;
  float xx = 0;
  float xy = 0;
  float yy = 0;
  for (int i = 0; i < kArea; ++i) {
    const float dx = pattern.dx[i] - sum_x / sum;
    const float dy = pattern.dy[i] - sum_y / sum;
    pattern.dx[i] = weight[i] * dx;
    pattern.dy[i] = weight[i] * dy;
    xx += weight[i] * dx * dx;
    xy += weight[i] * dx * dy;
    yy += weight[i] * dy * dy;
  }
  const float smaller = 0.5F * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy));
  pattern.texture = smaller / kArea;
  if (pattern.texture < kMinTexture) return Found::kNo;
  pattern.inverse_tensor << yy, -xy, -xy, xx;
  pattern.inverse_tensor /= xx * yy - xy * xy;
  return Found::kYes;
}

// The pattern's gradients times what the image differs from it. Summed in lanes, which the compiler
// may not do by itself.
WINDHOVER_MULTIVERSION
Eigen::Vector2f ProjectDifference(const Pattern& pattern, const Patch& value) {
  std::array<float, kLanes> x{};
  std::array<float, kLanes> y{};
  for (int i = 0; i < kPadded; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const float difference = value[i + lane] - pattern.value[i + lane];
      x[lane] += difference * pattern.dx[i + lane];
      y[lane] += difference * pattern.dy[i + lane];
    }
  }
  return {std::accumulate(x.begin(), x.end(), 0.0F), std::accumulate(y.begin(), y.end(), 0.0F)};
}

// Moves `at` to where `image` shows the pattern; inverse compositional Lucas-Kanade. The pattern's
// gradients have no mean, so that a difference in brightness does not pull.
Found FindPattern(const Pattern& pattern, const GrayView& image, int cell_px, Eigen::Vector2f& at) {
  const float max_correction = kMaxCorrection * static_cast<float>(cell_px);
  const float converged = kConverged * static_cast<float>(cell_px);
  const Eigen::Vector2f expected = at;
  Patch value{};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (!Sample(image, at, kSide, cell_px, value.data())) return Found::kUnseen;
    const Eigen::Vector2f step =
        pattern.inverse_tensor * ProjectDifference(pattern, value) * static_cast<float>(cell_px);
    at -= step;
    if (!((at - expected).squaredNorm() < max_correction * max_correction)) return Found::kNo;
    if (step.squaredNorm() < converged * converged) return Found::kYes;
  }
  return Found::kYes;
}

}  // namespace

ForwardBackwardFilter::ForwardBackwardFilter(double margin_px) : margin_px_(margin_px) {}

void ForwardBackwardFilter::SetWindow(std::span<const WindowSample> window, std::size_t centre) {
  window_ = window;
  centre_ = centre;
  ways_ = {ChooseWay(-1), ChooseWay(1)};
}

// The nearest samples that are at least kStepFrames away.
ForwardBackwardFilter::Way ForwardBackwardFilter::ChooseWay(int direction) const {
  Way way;
  for (auto i = static_cast<std::ptrdiff_t>(centre_) + direction;
       i >= 0 && i < std::ssize(window_) && way.count < kSteps; i += direction) {
    if (std::abs(window_[i].offset_frames) < kStepFrames[way.count]) continue;
    way.samples[way.count++] = static_cast<std::size_t>(i);
  }
  return way;
}

ForwardBackwardFilter::Outcome ForwardBackwardFilter::FollowWay(const Way& way,
                                                                const Eigen::Vector2f& seed,
                                                                const Eigen::Vector2f& velocity_px,
                                                                int cell_px) const {
  Outcome outcome;
  Eigen::Vector2f at = seed;
  Eigen::Vector2f velocity = velocity_px;
  std::size_t here = centre_;
  Pattern pattern;
  const auto go = [&](std::size_t there) {
    Found found = TakePattern(window_[here], at, cell_px, pattern);
    if (found != Found::kYes) return found;
    const auto frames =
        static_cast<float>(window_[there].offset_frames - window_[here].offset_frames);
    const Eigen::Vector2f from = at;
    at += frames * velocity;
    found = FindPattern(pattern, window_[there].registered, cell_px, at);
    velocity = (at - from) / frames;
    here = there;
    return found;
  };
  for (int i = 0; i < way.count; ++i) {
    const Found found = go(way.samples[i]);
    if (found == Found::kUnseen) return outcome;
    if (found == Found::kNo) {
      outcome.followed = true;
      return outcome;
    }
  }
  outcome.end = at;
  outcome.end_offset_frames = window_[here].offset_frames;
  // The way back knows nothing of the way forward but where it ended and what was expected at
  // first.
  velocity = velocity_px;
  for (int i = way.count - 2; i >= -1; --i) {
    const Found found = go(i < 0 ? centre_ : way.samples[i]);
    if (found == Found::kUnseen) return outcome;
    outcome.followed = true;
    if (found == Found::kNo) return outcome;
  }
  outcome.converged = true;
  outcome.error_px = (at - seed).norm();
  return outcome;
}

float ForwardBackwardFilter::Texture(const Eigen::Vector2f& seed, int cell_px) const {
  Pattern pattern;
  return TakePattern(window_[centre_], seed, cell_px, pattern) == Found::kUnseen ? 0.0F
                                                                                 : pattern.texture;
}

ForwardBackwardFilter::Trace ForwardBackwardFilter::Follow(const Eigen::Vector2f& seed,
                                                           const Eigen::Vector2f& velocity_px,
                                                           int cell_px) const {
  Trace trace;
  Eigen::Vector2f first = seed;
  Eigen::Vector2f last = seed;
  int frames = 0;
  int good = 0;
  for (const Way& way : ways_) {
    if (way.count == 0) continue;
    const Outcome outcome = FollowWay(way, seed, velocity_px, cell_px);
    if (!outcome.followed) continue;
    ++trace.directions;
    if (!outcome.converged || !(outcome.error_px <= margin_px_)) continue;
    ++good;
    trace.error_px = std::max(trace.error_px, outcome.error_px);
    (outcome.end_offset_frames < 0 ? first : last) = outcome.end;
    frames += std::abs(outcome.end_offset_frames);
  }
  trace.kept = trace.directions == 0 || good > 0;
  trace.velocity_px =
      frames > 0 ? Eigen::Vector2f((last - first) / static_cast<float>(frames)) : velocity_px;
  return trace;
}

}  // namespace windhover
