// SPDX-License-Identifier: Apache-2.0
#include "service/vision/motion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "service/vision/extraction.h"
#include "service/vision/forward_backward.h"
#include "service/vision/motion_fragments.h"
#include "service/vision/motion_window.h"
#include "service/vision/tracking.h"
#include "service/vision/voting.h"

namespace windhover {
namespace {

// Seeds so near to the border of the frame are left out, px.
constexpr double kBorderPx = 4.0;
// Seeds of a component among which those are chosen that the forward-backward filter looks at, and
// how many it looks at. They are spread evenly over the component.
constexpr int kPointsLookedAt = 10;
constexpr int kPointsPerComponent = 4;
// Share of the points that can be followed that must be kept.
constexpr double kLeastKept = 0.4;
// What it says, 0 to 1, where none can be.
constexpr double kUndecided = 0.5;
// Rows of the picture for each px of the dilation that is chosen by itself.
constexpr int kRowsPerDilation = 400;
// The forward-backward filter's cells grow with the component: one px for each so many px of the
// square root of its area.
constexpr double kSidePerCell = 12.0;

TrackingSettings TrackingOf(const MotionOptions& options) {
  return {.max_speed_px = options.max_speed_px,
          .min_travel_px = options.min_travel_px,
          .min_track_frames = options.min_track_frames,
          .max_coast_frames = options.max_coast_frames};
}

BitView ViewOf(const MappedImage<const std::uint32_t>& words, const BitImage& image) {
  return {words.data(), words.stride(), image.width, image.height};
}

GrayView ViewOf(const MappedImage<const std::uint8_t>& image) {
  return {image.data(), image.stride(), image.width(), image.height()};
}

// The part of the box inside the frame; of no size where there is none.
Box Clip(const Box& box, int width, int height) {
  const double left = std::clamp<double>(box.x, 0, width);
  const double top = std::clamp<double>(box.y, 0, height);
  const double right = std::clamp<double>(box.x + box.width, 0, width);
  const double bottom = std::clamp<double>(box.y + box.height, 0, height);
  return {left, top, right - left, bottom - top};
}

// A component that moves, its velocity still on the grid.
struct Found {
  MotionCandidate candidate;
  double area_px = 0.0;
};

// Adds `part` to `whole`.
void Join(Found& whole, const Found& part) {
  MotionCandidate& a = whole.candidate;
  const MotionCandidate& b = part.candidate;
  const double share = part.area_px / (whole.area_px + part.area_px);
  const double right = std::max(a.box.x + a.box.width, b.box.x + b.box.width);
  const double bottom = std::max(a.box.y + a.box.height, b.box.y + b.box.height);
  a.box.x = std::min(a.box.x, b.box.x);
  a.box.y = std::min(a.box.y, b.box.y);
  a.box.width = right - a.box.x;
  a.box.height = bottom - a.box.y;
  a.velocity_px += share * (b.velocity_px - a.velocity_px);
  a.confidence += share * (b.confidence - a.confidence);
  whole.area_px += part.area_px;
}

// Pixels first..last of row y that lie inside a convex polygon; first > last where none does.
std::pair<int, int> InsideOnRow(std::span<const Eigen::Vector2d> corners, int y, int width) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    if (std::min(a.y(), b.y()) > y || std::max(a.y(), b.y()) < y) continue;
    const double t = a.y() == b.y() ? 1.0 : (y - a.y()) / (b.y() - a.y());
    const double x = a.x() + t * (b.x() - a.x());
    low = std::min(low, x);
    high = std::max(high, x);
  }
  if (!(low <= high)) return {0, -1};
  return {static_cast<int>(std::ceil(std::max(low, 0.0))),
          static_cast<int>(std::floor(std::min(high, width - 1.0)))};
}

}  // namespace

struct MotionDetection::State {
  explicit State(const MotionOptions& motion_options)
      : options(motion_options),
        voting(options.max_speed_px, options.vote_share),
        extraction(options.erosion_px, std::max(0, options.dilation_px), options.min_area_px),
        forward_backward(options.forward_backward_margin_px),
        tracking(TrackingOf(options)) {}

  void MapWindow(const MotionEvidence& evidence);
  void UnmapWindow();
  void MaskBorder(const MotionEvidence& evidence);
  void FindCandidates(const MotionEvidence& evidence);
  void ChoosePoints(const SeedComponent& component);
  bool Examine(const SeedComponent& component, MotionCandidate& candidate);
  void JoinCandidates(const MotionEvidence& evidence);

  MotionOptions options;
  VotingFilter voting;
  SeedExtraction extraction;
  ForwardBackwardFilter forward_backward;
  Tracking tracking;

  // The window while a frame is worked on.
  std::vector<MappedImage<const std::uint32_t>> seeds;
  std::vector<MappedImage<const std::uint8_t>> registered;
  std::vector<WindowSample> window;

  // A seed that stands for its component.
  struct Point {
    Eigen::Vector2f at;
    SeedVote vote;
    float texture = 0.0F;
  };

  BitPlane inner;
  BitPlane kept;
  std::vector<Point> points;
  int cell_px = 1;
  std::vector<Found> found;
  std::vector<MotionFragment> fragments;  // of the same indices
  std::vector<MotionCandidate> candidates;
};

MotionDetection::MotionDetection(const MotionOptions& options)
    : state_(std::make_unique<State>(options)) {}

MotionDetection::~MotionDetection() = default;

void MotionDetection::Reset() { state_->tracking.Reset(); }

const std::vector<Detection>& MotionDetection::Detect(const MotionEvidence& evidence) {
  State& s = *state_;
  s.candidates.clear();
  if (evidence.centre < evidence.samples.size()) {
    // Mapped no longer than this, even where a device fails.
    const std::unique_ptr<State, void (*)(State*)> unmap(&s, [](State* at) { at->UnmapWindow(); });
    s.MapWindow(evidence);
    s.FindCandidates(evidence);
  }
  return s.tracking.Update(evidence.registration, s.candidates);
}

void MotionDetection::State::MapWindow(const MotionEvidence& evidence) {
  for (const MotionEvidence::Sample& sample : evidence.samples) {
    seeds.push_back(sample.seeds->words.Read());
    registered.push_back(sample.registered->Read());
    window.push_back(
        {ViewOf(seeds.back(), *sample.seeds), ViewOf(registered.back()), sample.offset_frames});
  }
}

void MotionDetection::State::UnmapWindow() {
  window.clear();
  seeds.clear();
  registered.clear();
}

void MotionDetection::State::FindCandidates(const MotionEvidence& evidence) {
  MaskBorder(evidence);
  if (options.vote_share > 0) {
    voting.Run(window, evidence.centre, kept);
  } else {
    kept = inner;
  }
  const BitView left = kept.View();
  if (options.dilation_px < 0) {
    extraction.set_dilation(
        std::max(1, (evidence.frame_height + kRowsPerDilation / 2) / kRowsPerDilation));
  }
  const std::vector<SeedComponent>& components = extraction.Run(left, evidence.frame_from_grid);
  forward_backward.SetWindow(window, evidence.centre);

  found.clear();
  fragments.clear();
  for (const SeedComponent& component : components) {
    MotionCandidate candidate;
    candidate.box = component.box;
    if (!Examine(component, candidate)) continue;
    found.push_back({candidate, static_cast<double>(component.area_px)});
    fragments.push_back({component.left, component.top, component.right, component.bottom,
                         candidate.velocity_px.cast<float>()});
  }
  if (evidence.background != nullptr && fragments.size() > 1) {
    const auto background = evidence.background->Read();
    JoinFragments({window, evidence.centre, ViewOf(background)}, fragments);
  } else {
    for (std::size_t i = 0; i < fragments.size(); ++i) fragments[i].object = static_cast<int>(i);
  }
  JoinCandidates(evidence);
}

// One candidate for each object, in frame coordinates.
void MotionDetection::State::JoinCandidates(const MotionEvidence& evidence) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto object = static_cast<std::size_t>(fragments[i].object);
    if (object != i) Join(found[object], found[i]);
  }
  const auto to_frame = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return (evidence.frame_from_grid * x.homogeneous()).hnormalized();
  };
  const double max_side = options.max_size * std::min(evidence.frame_width, evidence.frame_height);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const MotionFragment& fragment = fragments[i];
    if (fragment.object != static_cast<int>(i)) continue;
    MotionCandidate candidate = found[i].candidate;
    candidate.box = Clip(candidate.box, evidence.frame_width, evidence.frame_height);
    if (candidate.box.width <= 0 || candidate.box.height <= 0) continue;
    if (std::max(candidate.box.width, candidate.box.height) > max_side) continue;
    const Eigen::Vector2d on_grid(0.5 * (fragment.left + fragment.right),
                                  0.5 * (fragment.top + fragment.bottom));
    candidate.velocity_px = to_frame(on_grid + candidate.velocity_px) - to_frame(on_grid);
    candidates.push_back(candidate);
  }
}

// The centre frame's seeds without those along the border of that frame. The rows and columns at
// the very border of a picture are often not of the scene: codecs and resamplers darken or repeat
// them.
void MotionDetection::State::MaskBorder(const MotionEvidence& evidence) {
  WindowSample& centre = window[evidence.centre];
  const BitView& all = centre.seeds;
  inner.Reset(all.width, all.height);
  const Eigen::Matrix3d grid_from_frame = evidence.frame_from_grid.inverse();
  const double right = evidence.frame_width - 1 - kBorderPx;
  const double bottom = evidence.frame_height - 1 - kBorderPx;
  if (right < kBorderPx || bottom < kBorderPx) return;
  std::array<Eigen::Vector2d, 4> corners = {
      Eigen::Vector2d(kBorderPx, kBorderPx), Eigen::Vector2d(right, kBorderPx),
      Eigen::Vector2d(right, bottom), Eigen::Vector2d(kBorderPx, bottom)};
  for (Eigen::Vector2d& corner : corners) {
    corner = (grid_from_frame * corner.homogeneous()).hnormalized();
  }
  for (int y = 0; y < all.height; ++y) {
    const auto [first, last] = InsideOnRow(corners, y, all.width);
    for (int i = std::max(first, 0) / 32; i <= last / 32 && first <= last; ++i) {
      const int from = std::max(first - 32 * i, 0);
      const int to = std::min(last - 32 * i, 31);
      inner.row(y)[i] = all.row(y)[i] & (~0U << from) & (~0U >> (31 - to));
    }
  }
  centre.seeds = inner.View();
}

// Judges a component by a few of its seeds. Sets the candidate's confidence and its velocity on the
// grid.
bool MotionDetection::State::Examine(const SeedComponent& component, MotionCandidate& candidate) {
  const bool votes = options.vote_share > 0;
  const bool follows = options.forward_backward_margin_px > 0;
  ChoosePoints(component);
  Eigen::Vector2f voted = Eigen::Vector2f::Zero();
  Eigen::Vector2f followed = Eigen::Vector2f::Zero();
  float share = 0;
  int judged = 0;
  int kept_points = 0;
  for (const Point& point : points) {
    voted += point.vote.velocity_px;
    share += point.vote.share;
    if (point.texture < ForwardBackwardFilter::kMinTexture) continue;
    const ForwardBackwardFilter::Trace trace =
        forward_backward.Follow(point.at, point.vote.velocity_px, cell_px);
    if (trace.directions == 0) continue;
    ++judged;
    if (!trace.kept) continue;
    ++kept_points;
    followed += trace.velocity_px;
  }
  if (kept_points < kLeastKept * judged) return false;
  const auto count = static_cast<float>(points.size());
  candidate.has_velocity = votes || kept_points > 0;
  const Eigen::Vector2f velocity =
      kept_points > 0 ? followed / static_cast<float>(kept_points) : voted / count;
  if (candidate.has_velocity && velocity.norm() < options.min_speed_px) return false;
  candidate.velocity_px = velocity.cast<double>();
  // Where nothing could be followed, the forward-backward filter is taken to be undecided.
  const double agreed = judged > 0 ? static_cast<double>(kept_points) / judged : kUndecided;
  candidate.confidence = (votes ? share / count : 1.0) * (follows ? agreed : 1.0);
  return true;
}

// Seeds spread evenly over the component, and of those the ones with most texture.
void MotionDetection::State::ChoosePoints(const SeedComponent& component) {
  points.clear();
  cell_px = std::clamp(static_cast<int>(std::lround(std::sqrt(component.area_px) / kSidePerCell)),
                       1, ForwardBackwardFilter::kMaxCellPx);
  const int count = std::min(kPointsLookedAt, component.area_px);
  const BitRun* piece = extraction.pieces().data() + component.first_piece;
  int before = 0;  // seeds in the pieces before this one
  for (int i = 0; i < count; ++i) {
    const int seed = (2 * i + 1) * component.area_px / (2 * count);
    while (seed - before > piece->last - piece->first) {
      before += piece->last - piece->first + 1;
      ++piece;
    }
    Point point;
    const int x = piece->first + seed - before;
    point.at = {static_cast<float>(x), static_cast<float>(piece->y)};
    if (options.vote_share > 0) point.vote = voting.At(x, piece->y);
    if (options.forward_backward_margin_px > 0)
      point.texture = forward_backward.Texture(point.at, cell_px);
    points.push_back(point);
  }
  if (count <= kPointsPerComponent) return;
  std::nth_element(points.begin(), points.begin() + kPointsPerComponent, points.end(),
                   [](const Point& a, const Point& b) { return a.texture > b.texture; });
  points.resize(kPointsPerComponent);
}

}  // namespace windhover
