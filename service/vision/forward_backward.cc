// SPDX-License-Identifier: Apache-2.0
#include "service/vision/forward_backward.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace windhover {
namespace {

constexpr int kRadius = 4;
constexpr int kSide = 2 * kRadius + 1;
constexpr int kArea = kSide * kSide;
constexpr int kStepFrames = 2;
constexpr int kIterations = 12;
constexpr float kConvergedPx = 0.02F;
// Further from the expected place a pattern is not looked for, px.
constexpr float kMaxCorrectionPx = 4.0F;
// Smallest eigenvalue of the patch's mean gradient tensor, (grey levels / px)^2, with which it can
// be followed at all.
constexpr float kMinTexture = 1.0F;

// Ground seen in all pixels that bilinear interpolation of a patch with `border` px around it
// needs.
bool Inside(const GrayView& image, const Eigen::Vector2f& at, int border) {
  const float x = std::floor(at.x());
  const float y = std::floor(at.y());
  const auto reach = static_cast<float>(kRadius + border);
  return x >= reach && y >= reach && x + reach + 1 < static_cast<float>(image.width) &&
         y + reach + 1 < static_cast<float>(image.height);
}

// Samples a square of pixels around `at`, Side across, bilinearly. False where a pixel is unseen.
template <int Side>
bool Sample(const GrayView& image, const Eigen::Vector2f& at, float* out) {
  const int x = static_cast<int>(std::floor(at.x()));
  const int y = static_cast<int>(std::floor(at.y()));
  const float fx = at.x() - static_cast<float>(x);
  const float fy = at.y() - static_cast<float>(y);
  const float w00 = (1 - fx) * (1 - fy);
  const float w01 = fx * (1 - fy);
  const float w10 = (1 - fx) * fy;
  const float w11 = fx * fy;
  int smallest = 255;
  for (int j = 0; j < Side; ++j) {
    const std::uint8_t* upper = image.row(y - Side / 2 + j) + x - Side / 2;
    const std::uint8_t* lower = upper + image.stride;
    for (int i = 0; i < Side; ++i) {
      smallest = std::min<int>(smallest, upper[i]);
      out[j * Side + i] =
          w00 * static_cast<float>(upper[i]) + w01 * static_cast<float>(upper[i + 1]) +
          w10 * static_cast<float>(lower[i]) + w11 * static_cast<float>(lower[i + 1]);
    }
  }
  return smallest > 0;
}

struct Pattern {
  std::array<float, kArea> value;
  std::array<float, kArea> dx;
  std::array<float, kArea> dy;
  float mean = 0;
  Eigen::Matrix2f inverse_tensor;
};

enum class Found { kYes, kNo, kUnseen };

Found TakePattern(const GrayView& image, const Eigen::Vector2f& at, Pattern& pattern) {
  constexpr int kWide = kSide + 2;
  std::array<float, kWide * kWide> wide;
  if (!Inside(image, at, 1) || !Sample<kWide>(image, at, wide.data())) return Found::kUnseen;
  float sum = 0;
  float xx = 0;
  float xy = 0;
  float yy = 0;
  float sum_x = 0;
  float sum_y = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const float* p = &wide[(j + 1) * kWide + i + 1];
      const float dx = 0.5F * (p[1] - p[-1]);
      const float dy = 0.5F * (p[kWide] - p[-kWide]);
      pattern.value[j * kSide + i] = *p;
      pattern.dx[j * kSide + i] = dx;
      pattern.dy[j * kSide + i] = dy;
      sum += *p;
      sum_x += dx;
      sum_y += dy;
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  pattern.mean = sum / kArea;
  xx -= sum_x * sum_x / kArea;
  xy -= sum_x * sum_y / kArea;
  yy -= sum_y * sum_y / kArea;
  for (int i = 0; i < kArea; ++i) {
    pattern.value[i] -= pattern.mean;
    pattern.dx[i] -= sum_x / kArea;
    pattern.dy[i] -= sum_y / kArea;
  }
  const float smaller = 0.5F * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy));
  if (smaller < kMinTexture * kArea) return Found::kNo;
  pattern.inverse_tensor << yy, -xy, -xy, xx;
  pattern.inverse_tensor /= xx * yy - xy * xy;
  return Found::kYes;
}

// Moves `at` to where `image` shows the pattern; inverse compositional Lucas-Kanade. The pattern's
// gradients have no mean, so that a difference in brightness does not pull.
Found FindPattern(const Pattern& pattern, const GrayView& image, Eigen::Vector2f& at) {
  const Eigen::Vector2f expected = at;
  std::array<float, kArea> value;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (!Inside(image, at, 0) || !Sample<kSide>(image, at, value.data())) return Found::kUnseen;
    float x = 0;
    float y = 0;
    for (int i = 0; i < kArea; ++i) {
      const float error = value[i] - pattern.value[i];
      x += error * pattern.dx[i];
      y += error * pattern.dy[i];
    }
    const Eigen::Vector2f step = pattern.inverse_tensor * Eigen::Vector2f(x, y);
    at -= step;
    if (!((at - expected).squaredNorm() < kMaxCorrectionPx * kMaxCorrectionPx)) return Found::kNo;
    if (step.squaredNorm() < kConvergedPx * kConvergedPx) return Found::kYes;
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

// The samples next to kStepFrames, 2 kStepFrames, ... from the centre.
ForwardBackwardFilter::Way ForwardBackwardFilter::ChooseWay(int direction) const {
  Way way;
  int next = kStepFrames;
  for (auto i = static_cast<std::ptrdiff_t>(centre_) + direction;
       i >= 0 && i < std::ssize(window_) && way.count < kSteps; i += direction) {
    if (std::abs(window_[i].offset_frames) < next) continue;
    way.samples[way.count++] = static_cast<std::size_t>(i);
    next = std::abs(window_[i].offset_frames) + kStepFrames;
  }
  return way;
}

ForwardBackwardFilter::Outcome ForwardBackwardFilter::FollowWay(
    const Way& way, const Eigen::Vector2f& seed, const Eigen::Vector2f& velocity_px) const {
  Outcome outcome;
  Eigen::Vector2f at = seed;
  Eigen::Vector2f velocity = velocity_px;
  std::size_t here = centre_;
  Pattern pattern;
  const auto go = [&](std::size_t there) {
    Found found = TakePattern(window_[here].registered, at, pattern);
    if (found != Found::kYes) return found;
    const auto frames =
        static_cast<float>(window_[there].offset_frames - window_[here].offset_frames);
    const Eigen::Vector2f from = at;
    at += frames * velocity;
    found = FindPattern(pattern, window_[there].registered, at);
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

ForwardBackwardFilter::Trace ForwardBackwardFilter::Follow(
    const Eigen::Vector2f& seed, const Eigen::Vector2f& velocity_px) const {
  Trace trace;
  trace.kept = true;
  Eigen::Vector2f first = seed;
  Eigen::Vector2f last = seed;
  int frames = 0;
  for (const Way& way : ways_) {
    if (way.count == 0) continue;
    const Outcome outcome = FollowWay(way, seed, velocity_px);
    if (!outcome.followed) continue;
    ++trace.directions;
    if (!outcome.converged || !(outcome.error_px <= margin_px_)) {
      trace.kept = false;
      if (!outcome.converged) continue;
    }
    trace.error_px = std::max(trace.error_px, outcome.error_px);
    (outcome.end_offset_frames < 0 ? first : last) = outcome.end;
    frames += std::abs(outcome.end_offset_frames);
  }
  trace.velocity_px =
      frames > 0 ? Eigen::Vector2f((last - first) / static_cast<float>(frames)) : velocity_px;
  return trace;
}

}  // namespace windhover
