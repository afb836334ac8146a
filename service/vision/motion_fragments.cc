// SPDX-License-Identifier: Apache-2.0
#include "service/vision/motion_fragments.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace windhover {
namespace {

// Velocities are alike where they differ by no more than this, px a frame, and this share.
constexpr float kVelocityTolerancePx = 0.3F;
constexpr float kVelocityToleranceShare = 0.1F;
// Longest gap in units of the longer side of both.
constexpr float kLongestGap = 2.2F;
constexpr float kLeastHalfWidthPx = 3.0F;
// Patches of 5x5 px, so far apart along the gap.
constexpr int kRadius = 2;
constexpr int kArea = (2 * kRadius + 1) * (2 * kRadius + 1);
constexpr float kPatchDistancePx = 5.0F;
// Frames are compared between which the motion is so long, px, that a patch has left its place.
constexpr float kLeastMotionPx = 6.0F;
// A patch moves where its mean squared difference along the motion is at most this share of the one
// at rest, and rests the other way round; where the larger one is no more than noise,
// (grey levels)^2, it may be either.
constexpr float kDecisiveShare = 0.5F;
constexpr float kNoise = 12.0F;
// Largest length of a thing in units of its width at which what is unclear is taken to move.
constexpr float kLongestShape = 3.2F;

// The gap between two fragments: the shortest line between their boxes.
struct Gap {
  Eigen::Vector2f from;
  Eigen::Vector2f to;
};

void Bridge(int a_low, int a_high, int b_low, int b_high, float& from, float& to) {
  if (a_high < b_low) {
    from = static_cast<float>(a_high);
    to = static_cast<float>(b_low);
  } else if (b_high < a_low) {
    from = static_cast<float>(a_low);
    to = static_cast<float>(b_high);
  } else {
    from = to = 0.5F * static_cast<float>(std::max(a_low, b_low) + std::min(a_high, b_high));
  }
}

Gap GapBetween(const MotionFragment& a, const MotionFragment& b) {
  Gap gap;
  Bridge(a.left, a.right, b.left, b.right, gap.from.x(), gap.to.x());
  Bridge(a.top, a.bottom, b.top, b.bottom, gap.from.y(), gap.to.y());
  return gap;
}

float LongerSide(const MotionFragment& fragment) {
  return static_cast<float>(
      std::max(fragment.right - fragment.left, fragment.bottom - fragment.top) + 1);
}

bool MoveAlike(const MotionFragment& a, const MotionFragment& b) {
  const float speed = std::max(a.velocity_px.norm(), b.velocity_px.norm());
  return (a.velocity_px - b.velocity_px).norm() <=
         kVelocityTolerancePx + kVelocityToleranceShare * speed;
}

Eigen::Vector2f Centre(const MotionFragment& fragment) {
  return {0.5F * static_cast<float>(fragment.left + fragment.right),
          0.5F * static_cast<float>(fragment.top + fragment.bottom)};
}

float ShorterSide(const MotionFragment& fragment) {
  return static_cast<float>(
      std::min(fragment.right - fragment.left, fragment.bottom - fragment.top) + 1);
}

// Whether one follows the other: their centres lie along the motion, give or take half a width.
// What does not move follows nothing.
bool FollowEachOther(const MotionFragment& a, const MotionFragment& b) {
  const Eigen::Vector2f between = Centre(b) - Centre(a);
  const Eigen::Vector2f direction = (a.velocity_px + b.velocity_px).normalized();
  if (direction.isZero()) return false;
  const float along = std::abs(between.dot(direction));
  const float across = std::abs(between.x() * direction.y() - between.y() * direction.x());
  const float half_width = 0.5F * std::max(ShorterSide(a), ShorterSide(b));
  return across <= std::max(kLeastHalfWidthPx, half_width) && across <= 0.5F * along;
}

bool Fits(const GrayView& image, int x, int y) {
  return x >= kRadius && y >= kRadius && x + kRadius < image.width && y + kRadius < image.height;
}

// Mean squared difference between a's patch at (ax, ay) and b's at (bx, by); negative where one of
// them is not all seen.
float Difference(const GrayView& a, int ax, int ay, const GrayView& b, int bx, int by) {
  if (!Fits(a, ax, ay) || !Fits(b, bx, by)) return -1.0F;
  int sum = 0;
  int smallest = 255;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    const std::uint8_t* in_a = a.row(ay + dy) + ax;
    const std::uint8_t* in_b = b.row(by + dy) + bx;
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      const int difference = in_a[dx] - in_b[dx];
      sum += difference * difference;
      smallest = std::min<int>({smallest, in_a[dx], in_b[dx]});
    }
  }
  return smallest == 0 ? -1.0F : static_cast<float>(sum) / kArea;
}

enum class Ground { kMoves, kRests, kUnclear };

// Whether what the centre frame shows at `at` moves with `velocity_px`, by the nearest frame on
// each side in which it would have left its place, or is the resting background.
Ground Judge(const FragmentSurroundings& around, const Eigen::Vector2f& at,
             const Eigen::Vector2f& velocity_px) {
  const GrayView& here = around.window[around.centre].registered;
  const int x = static_cast<int>(std::lround(at.x()));
  const int y = static_cast<int>(std::lround(at.y()));
  const float resting = Difference(here, x, y, around.background, x, y);
  if (resting < 0) return Ground::kUnclear;
  const float speed = velocity_px.norm();
  float moving = 0;
  int frames_seen = 0;
  for (const int direction : {-1, 1}) {
    for (auto i = static_cast<std::ptrdiff_t>(around.centre) + direction;
         i >= 0 && i < std::ssize(around.window); i += direction) {
      const auto frames = static_cast<float>(around.window[i].offset_frames);
      if (speed * std::abs(frames) < kLeastMotionPx) continue;
      const int there_x = static_cast<int>(std::lround(at.x() + frames * velocity_px.x()));
      const int there_y = static_cast<int>(std::lround(at.y() + frames * velocity_px.y()));
      const float along = Difference(here, x, y, around.window[i].registered, there_x, there_y);
      if (along >= 0) {
        moving += along;
        ++frames_seen;
      }
      break;
    }
  }
  if (frames_seen == 0) return Ground::kUnclear;
  moving /= static_cast<float>(frames_seen);
  if (resting > kNoise && moving < kDecisiveShare * resting) return Ground::kMoves;
  if (moving > kNoise && resting < kDecisiveShare * moving) return Ground::kRests;
  return Ground::kUnclear;
}

// Whether both together are no longer, along the motion, than a vehicle as wide as the wider one.
bool ShapedAsOne(const MotionFragment& a, const MotionFragment& b) {
  const Eigen::Vector2f direction = (a.velocity_px + b.velocity_px).normalized().cwiseAbs();
  const Eigen::Vector2f size_a(a.right - a.left + 1, a.bottom - a.top + 1);
  const Eigen::Vector2f size_b(b.right - b.left + 1, b.bottom - b.top + 1);
  const Eigen::Vector2f both(std::max(a.right, b.right) - std::min(a.left, b.left) + 1,
                             std::max(a.bottom, b.bottom) - std::min(a.top, b.top) + 1);
  const Eigen::Vector2f across(direction.y(), direction.x());
  return both.dot(direction) <= kLongestShape * std::max(size_a.dot(across), size_b.dot(across));
}

bool AreOne(const FragmentSurroundings& around, const MotionFragment& a, const MotionFragment& b) {
  const Gap gap = GapBetween(a, b);
  const float length = (gap.to - gap.from).norm();
  if (length > kLongestGap * std::max(LongerSide(a), LongerSide(b)) || !MoveAlike(a, b) ||
      !FollowEachOther(a, b)) {
    return false;
  }
  const bool shaped_as_one = ShapedAsOne(a, b);
  const Eigen::Vector2f velocity = 0.5F * (a.velocity_px + b.velocity_px);
  const int patches = std::max(1, static_cast<int>(length / kPatchDistancePx));
  for (int i = 1; i <= patches; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(patches + 1);
    const Ground ground = Judge(around, gap.from + t * (gap.to - gap.from), velocity);
    if (ground == Ground::kRests || (ground == Ground::kUnclear && !shaped_as_one)) return false;
  }
  return true;
}

}  // namespace

void JoinFragments(const FragmentSurroundings& around, std::vector<MotionFragment>& fragments) {
  const int count = static_cast<int>(fragments.size());
  for (int i = 0; i < count; ++i) fragments[i].object = i;
  for (int i = 1; i < count; ++i) {
    for (int j = 0; j < i; ++j) {
      const int joined = fragments[i].object;
      const int first = fragments[j].object;
      if (joined == first || !AreOne(around, fragments[j], fragments[i])) continue;
      const int from = std::max(joined, first);
      const int to = std::min(joined, first);
      for (int k = 0; k <= i; ++k) {
        if (fragments[k].object == from) fragments[k].object = to;
      }
    }
  }
}

}  // namespace windhover
