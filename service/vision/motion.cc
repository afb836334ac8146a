// SPDX-License-Identifier: Apache-2.0
#include "service/vision/motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "service/vision/extraction.h"
#include "service/vision/forward_backward.h"
#include "service/vision/motion_window.h"
#include "service/vision/tracking.h"
#include "service/vision/voting.h"

namespace windhover {
namespace {

// Seeds of one component that the forward-backward filter looks at, spread evenly over it.
constexpr int kPointsPerComponent = 5;
// Share of them that must be kept.
constexpr double kLeastKept = 0.5;

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

}  // namespace

struct MotionDetection::State {
  explicit State(const MotionOptions& motion_options)
      : options(motion_options),
        voting(options.max_speed_px, options.vote_share),
        extraction(options.erosion_px, options.dilation_px, options.min_area_px),
        forward_backward(options.forward_backward_margin_px),
        tracking(TrackingOf(options)) {}

  void MapWindow(const MotionEvidence& evidence);
  void UnmapWindow();
  void FindCandidates(const MotionEvidence& evidence);
  bool Examine(const SeedComponent& component, MotionCandidate& candidate,
               Eigen::Vector2d& at) const;

  MotionOptions options;
  VotingFilter voting;
  SeedExtraction extraction;
  ForwardBackwardFilter forward_backward;
  Tracking tracking;

  // The window while a frame is worked on.
  std::vector<MappedImage<const std::uint32_t>> seeds;
  std::vector<MappedImage<const std::uint8_t>> registered;
  std::vector<WindowSample> window;

  BitPlane kept;
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
    s.MapWindow(evidence);
    s.FindCandidates(evidence);
    s.UnmapWindow();
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
  const bool votes = options.vote_share > 0;
  if (votes) voting.Run(window, evidence.centre, kept);
  const BitView left = votes ? kept.View() : window[evidence.centre].seeds;
  const std::vector<SeedComponent>& components = extraction.Run(left, evidence.frame_from_grid);
  if (options.forward_backward_margin_px > 0) forward_backward.SetWindow(window, evidence.centre);

  const auto to_frame = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return (evidence.frame_from_grid * x.homogeneous()).hnormalized();
  };
  for (const SeedComponent& component : components) {
    MotionCandidate candidate;
    Eigen::Vector2d in_grid;
    if (!Examine(component, candidate, in_grid)) continue;
    candidate.box = Clip(component.box, evidence.frame_width, evidence.frame_height);
    if (candidate.box.width <= 0 || candidate.box.height <= 0) continue;
    candidate.velocity_px = to_frame(in_grid + candidate.velocity_px) - to_frame(in_grid);
    candidates.push_back(candidate);
  }
}

// Judges a component by a few of its seeds, as the forward-backward filter sees them. Sets the
// candidate's confidence and its velocity on the grid, and where on the grid that was measured.
bool MotionDetection::State::Examine(const SeedComponent& component, MotionCandidate& candidate,
                                     Eigen::Vector2d& at) const {
  const int points = std::min(kPointsPerComponent, component.area_px);
  const BitRun* piece = extraction.pieces().data() + component.first_piece;
  int before = 0;  // seeds in the pieces before this one
  int kept_points = 0;
  double share = 0;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  at.setZero();
  for (int i = 0; i < points; ++i) {
    const int seed = (2 * i + 1) * component.area_px / (2 * points);
    while (seed - before > piece->last - piece->first) {
      before += piece->last - piece->first + 1;
      ++piece;
    }
    const int x = piece->first + seed - before;
    const int y = piece->y;
    SeedVote vote;
    if (options.vote_share > 0) vote = voting.At(x, y);
    at += Eigen::Vector2d(x, y) / points;
    share += vote.share / points;
    Eigen::Vector2f measured = vote.velocity_px;
    if (options.forward_backward_margin_px > 0) {
      const ForwardBackwardFilter::Trace trace =
          forward_backward.Follow({static_cast<float>(x), static_cast<float>(y)}, vote.velocity_px);
      if (!trace.kept) continue;
      measured = trace.velocity_px;
    }
    ++kept_points;
    velocity += measured.cast<double>();
  }
  if (kept_points < kLeastKept * points) return false;
  candidate.velocity_px = velocity / kept_points;
  candidate.has_velocity = options.vote_share > 0 || options.forward_backward_margin_px > 0;
  const double followed = static_cast<double>(kept_points) / points;
  candidate.confidence = options.vote_share > 0 ? share * followed : followed;
  return true;
}

}  // namespace windhover
