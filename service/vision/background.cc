// SPDX-License-Identifier: Apache-2.0
#include "service/vision/background.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gpu-kernels/difference_threshold/difference_threshold.h"
#include "gpu-kernels/temporal_median/temporal_median.h"
#include "gpu-kernels/warp/warp.h"
#include "service/vision/homography.h"
#include "service/vision/pool.h"
#include "service/vision/tile_registration.h"

namespace windhover {
namespace {

// The grid reaches over the frame it is laid on by this share on each side, so that it can stay
// where it is while the camera moves on.
constexpr double kGridMarginShare = 0.05;
// Shares of the centre frame that must lie on the grid: for it to stay, and to be laid anew.
constexpr double kMinGridCover = 0.98;
constexpr double kFreshGridCover = 0.995;

constexpr int kNoGrid = -1;

int GridMargin(int side_px) {
  constexpr int kRound = 8;
  return static_cast<int>(side_px * kGridMarginShare) / kRound * kRound;
}

// A frame in the window. Poses are relative to the anchor that the newest frame was measured
// against.
struct HeldFrame {
  std::shared_ptr<GrayImage> gray;
  FrameRegistration registration;
  Eigen::Matrix3d anchor_from_frame = Eigen::Matrix3d::Identity();
  int segment = 0;
  std::shared_ptr<GrayImage> registered;
  int grid = kNoGrid;  // number of the grid that `registered` lies on
};

}  // namespace

struct BackgroundSubtraction::State {
  State(std::shared_ptr<Backend> backend_in, int width_in, int height_in,
        const BackgroundOptions& options_in, const RegistrationOptions& registration);

  bool IsComplete() const;
  bool CarryPoses(const FrameRegistration& registration);
  std::shared_ptr<MotionEvidence> Evidence();
  void LayGrid(std::size_t last);
  void RegisterThroughAnchor(std::size_t first, std::size_t last);
  void RegisterToCentre(std::size_t first, std::size_t last);
  void Subtract(MotionEvidence& evidence);

  std::shared_ptr<Backend> backend;
  int width;
  int height;
  BackgroundOptions options;
  int lookahead;
  int margin_x;
  int margin_y;
  std::unique_ptr<Warp> warp;
  std::unique_ptr<TemporalMedian> median;
  std::unique_ptr<DifferenceThreshold> difference;
  // In centre mode only; made with the first frame that has no anchor.
  RegistrationOptions registration_options;
  std::unique_ptr<TileRegistration> tiles;
  TileReference centre;

  Pool<GrayImage> frames;
  Pool<GrayImage> grid_images;
  Pool<BitImage> seed_images;
  Pool<MotionEvidence> evidences;
  std::vector<const GrayImage*> median_inputs;

  std::vector<HeldFrame> held;  // oldest first
  std::size_t next = 0;         // index of the oldest frame that has not come out
  bool draining = false;
  int segment = 0;
  int grid = kNoGrid;
  int grid_segment = 0;
  Eigen::Matrix3d grid_from_anchor = Eigen::Matrix3d::Identity();
};

BackgroundSubtraction::State::State(std::shared_ptr<Backend> backend_in, int width_in,
                                    int height_in, const BackgroundOptions& options_in,
                                    const RegistrationOptions& registration)
    : backend(std::move(backend_in)),
      width(width_in),
      height(height_in),
      options(options_in),
      lookahead(std::min(options.lookahead, options.k)),
      margin_x(GridMargin(width)),
      margin_y(GridMargin(height)),
      warp(backend->MakeWarp()),
      median(backend->MakeTemporalMedian()),
      difference(backend->MakeDifferenceThreshold()),
      registration_options(registration),
      frames([this] { return backend->MakeImage<std::uint8_t>(width, height); }),
      grid_images([this] {
        return backend->MakeImage<std::uint8_t>(width + 2 * margin_x, height + 2 * margin_y);
      }),
      seed_images(
          [this] { return backend->MakeBitImage(width + 2 * margin_x, height + 2 * margin_y); }),
      evidences([] { return MotionEvidence(); }) {}

bool BackgroundSubtraction::State::IsComplete() const {
  if (next >= held.size()) return false;
  const std::size_t last = next + static_cast<std::size_t>(lookahead);
  return draining || held.size() > last || held.back().segment != held[next].segment;
}

// Re-expresses all poses in the anchor of the newest frame. False where the newest frame cannot be
// laid over those held: nothing before it can be compared with it.
bool BackgroundSubtraction::State::CarryPoses(const FrameRegistration& registration) {
  if (held.empty() || registration.starts_segment) return false;
  const HeldFrame& newest = held.back();
  if (registration.anchor_from_frame.has_value() !=
      newest.registration.anchor_from_frame.has_value()) {
    return false;
  }
  if (!registration.anchor_from_frame ||
      newest.registration.anchor_number == registration.anchor_number) {
    return true;
  }
  const auto anchor = std::find_if(held.begin(), held.end(), [&](const HeldFrame& frame) {
    return frame.registration.frame_number == registration.anchor_number &&
           frame.segment == newest.segment;
  });
  if (anchor == held.end()) return false;
  const Eigen::Matrix3d new_from_old = InverseHomography(anchor->anchor_from_frame);
  for (HeldFrame& frame : held) {
    frame.anchor_from_frame = new_from_old * frame.anchor_from_frame;
    frame.anchor_from_frame /= frame.anchor_from_frame(2, 2);
  }
  grid_from_anchor = grid_from_anchor * new_from_old.inverse();
  return true;
}

// Lays the grid on the frame furthest ahead whose grid still holds the whole centre frame, so that
// it lasts long. Everything registered is registered anew.
void BackgroundSubtraction::State::LayGrid(std::size_t last) {
  const int grid_width = width + 2 * margin_x;
  const int grid_height = height + 2 * margin_y;
  Eigen::Matrix3d grid_from_frame = Eigen::Matrix3d::Identity();
  grid_from_frame(0, 2) = margin_x;
  grid_from_frame(1, 2) = margin_y;
  const HeldFrame& centre = held[next];
  if (grid != kNoGrid && grid_segment == centre.segment) {
    const Eigen::Matrix3d grid_from_centre = grid_from_anchor * centre.anchor_from_frame;
    if (OverlapShare(grid_from_centre, width, height, grid_width, grid_height) >= kMinGridCover) {
      return;
    }
  }
  for (std::size_t i = last + 1; i-- > next;) {
    grid_from_anchor = grid_from_frame * InverseHomography(held[i].anchor_from_frame);
    const Eigen::Matrix3d grid_from_centre = grid_from_anchor * centre.anchor_from_frame;
    if (OverlapShare(grid_from_centre, width, height, grid_width, grid_height) >= kFreshGridCover) {
      break;
    }
  }
  ++grid;
  grid_segment = centre.segment;
}

void BackgroundSubtraction::State::RegisterThroughAnchor(std::size_t first, std::size_t last) {
  LayGrid(last);
  for (std::size_t i = first; i <= last; ++i) {
    HeldFrame& frame = held[i];
    if (frame.grid == grid) continue;
    frame.registered = grid_images.Take();
    warp->Run(*frame.gray, ToMatrix3(InverseHomography(grid_from_anchor * frame.anchor_from_frame)),
              *frame.registered);
    frame.grid = grid;
  }
}

// The thesis' way (6.3): every frame of the window against its centre frame, predicted by the
// motion from frame to frame. A frame that cannot be registered takes no part.
void BackgroundSubtraction::State::RegisterToCentre(std::size_t first, std::size_t last) {
  if (tiles == nullptr) {
    tiles = std::make_unique<TileRegistration>(*backend, width, height, registration_options);
    centre = tiles->MakeReference();
  }
  grid_from_anchor.setIdentity();
  grid_from_anchor(0, 2) = margin_x;
  grid_from_anchor(1, 2) = margin_y;
  tiles->SetReference(*held[next].gray, centre);
  ++grid;

  const auto place = [&](std::size_t i, const Eigen::Matrix3d& predicted_frame_from_centre) {
    HeldFrame& frame = held[i];
    Eigen::Matrix3d frame_from_centre = Eigen::Matrix3d::Identity();
    if (i != next) {
      const TileMeasurement measurement =
          tiles->Measure(centre, *frame.gray, predicted_frame_from_centre);
      if (measurement.quality == RegistrationQuality::kLost) return predicted_frame_from_centre;
      frame_from_centre = InverseHomography(measurement.reference_from_frame);
    }
    frame.registered = grid_images.Take();
    warp->Run(*frame.gray, ToMatrix3(frame_from_centre * grid_from_anchor.inverse()),
              *frame.registered);
    frame.grid = grid;
    return frame_from_centre;
  };
  Eigen::Matrix3d from_centre = place(next, Eigen::Matrix3d::Identity());
  for (std::size_t i = next; i-- > first;) {
    from_centre = place(i, held[i + 1].registration.previous_from_frame * from_centre);
  }
  from_centre.setIdentity();
  for (std::size_t i = next + 1; i <= last; ++i) {
    from_centre =
        place(i, InverseHomography(held[i].registration.previous_from_frame) * from_centre);
  }
}

void BackgroundSubtraction::State::Subtract(MotionEvidence& evidence) {
  median_inputs.clear();
  for (const MotionEvidence::Sample& sample : evidence.samples) {
    median_inputs.push_back(sample.registered.get());
  }
  // Where fewer frames have seen the ground, what moves may itself be the median.
  const int count = static_cast<int>(median_inputs.size());
  const int min_samples = std::max(3, (2 * count + 4) / 5);
  auto background = grid_images.Take();
  median->Run(median_inputs, min_samples, *background);
  evidence.background = background;
  const DifferenceThresholdSettings settings = {
      .threshold = options.threshold,
      .gradient_gain_px = static_cast<float>(options.gradient_gain_px)};
  for (MotionEvidence::Sample& sample : evidence.samples) {
    auto seeds = seed_images.Take();
    difference->Run(*sample.registered, *background, settings, *seeds);
    sample.seeds = std::move(seeds);
  }
}

std::shared_ptr<MotionEvidence> BackgroundSubtraction::State::Evidence() {
  std::size_t first = next;
  const int segment_of_centre = held[next].segment;
  while (first > 0 && next - first < static_cast<std::size_t>(options.k) &&
         held[first - 1].segment == segment_of_centre) {
    --first;
  }
  std::size_t last = next;
  while (last + 1 < held.size() && last - next < static_cast<std::size_t>(lookahead) &&
         held[last + 1].segment == segment_of_centre) {
    ++last;
  }
  const bool anchored = held[next].registration.anchor_from_frame.has_value();
  if (anchored) {
    RegisterThroughAnchor(first, last);
  } else {
    RegisterToCentre(first, last);
  }

  auto evidence = evidences.Take();
  evidence->samples.clear();
  evidence->background.reset();
  evidence->registration = held[next].registration;
  evidence->frame_width = width;
  evidence->frame_height = height;
  const Eigen::Matrix3d grid_from_centre =
      anchored ? Eigen::Matrix3d(grid_from_anchor * held[next].anchor_from_frame)
               : grid_from_anchor;
  evidence->frame_from_grid = InverseHomography(grid_from_centre);
  for (std::size_t i = first; i <= last; ++i) {
    if (held[i].grid != grid) continue;
    if (i == next) evidence->centre = evidence->samples.size();
    evidence->samples.push_back(
        {held[i].registered, nullptr, static_cast<int>(i) - static_cast<int>(next)});
  }
  Subtract(*evidence);
  return evidence;
}

BackgroundSubtraction::BackgroundSubtraction(std::shared_ptr<Backend> backend, int width,
                                             int height, const BackgroundOptions& options,
                                             const RegistrationOptions& registration)
    : state_(std::make_unique<State>(std::move(backend), width, height, options, registration)) {
  CheckOptions(options);
  CheckOptions(registration);
}

BackgroundSubtraction::~BackgroundSubtraction() = default;

void BackgroundSubtraction::Push(const GrayImage& frame, const FrameRegistration& registration) {
  State& state = *state_;
  if (frame.width() != state.width || frame.height() != state.height) {
    throw std::invalid_argument("frame size differs from the one given at construction");
  }
  if (!state.CarryPoses(registration)) ++state.segment;
  HeldFrame& held = state.held.emplace_back();
  held.registration = registration;
  held.anchor_from_frame = registration.anchor_from_frame.value_or(Eigen::Matrix3d::Identity());
  held.segment = state.segment;
  held.gray = state.frames.Take();
  const auto from = frame.Read();
  const auto to = held.gray->Write();
  for (int y = 0; y < from.height(); ++y) std::copy_n(from.row(y), from.width(), to.row(y));
  state.draining = false;
}

void BackgroundSubtraction::Drain() { state_->draining = true; }

std::shared_ptr<const MotionEvidence> BackgroundSubtraction::Pop() {
  State& state = *state_;
  if (!state.IsComplete()) return nullptr;
  auto evidence = state.Evidence();
  ++state.next;
  if (state.next > static_cast<std::size_t>(state.options.k)) {
    state.held.erase(state.held.begin());
    --state.next;
  }
  return evidence;
}

void BackgroundSubtraction::Reset() {
  state_->held.clear();
  state_->next = 0;
  state_->draining = false;
  state_->grid = kNoGrid;
}

int BackgroundSubtraction::lookahead() const { return state_->lookahead; }

}  // namespace windhover
