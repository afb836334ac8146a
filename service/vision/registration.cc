// SPDX-License-Identifier: Apache-2.0
#include "service/vision/registration.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "service/vision/global_motion.h"
#include "service/vision/homography.h"
#include "service/vision/tile_layout.h"
#include "service/vision/tile_registration.h"

namespace windhover {
namespace {

constexpr double kUncontestedShare = 0.7;  // of the tiles
constexpr double kJumpShare = 0.1;         // of the frame's width

// The camera goes on turning and zooming as it did (`last_frame_from_previous`), but the picture's
// centre moves by the shift that was seen.
Eigen::Matrix3d WithCentreShift(const Eigen::Matrix3d& last_frame_from_previous,
                                const Eigen::Vector2d& shift_px, int width, int height) {
  const Eigen::Vector2d centre(0.5 * (width - 1), 0.5 * (height - 1));
  const Eigen::Vector2d correction = centre + shift_px - Project(last_frame_from_previous, centre);
  Eigen::Matrix3d translation = Eigen::Matrix3d::Identity();
  translation.topRightCorner<2, 1>() = correction;
  return translation * last_frame_from_previous;
}

// RMS of the four corners' distances from where they belong, px, as the covariance has it.
double PredictedError(const TileMeasurement& measurement) {
  return std::sqrt(measurement.corner_covariance.trace() / 4.0);
}

}  // namespace

struct StreamRegistration::State {
  State(std::shared_ptr<Backend> backend_in, int width_in, int height_in,
        const RegistrationOptions& options_in)
      : backend(std::move(backend_in)),
        width(width_in),
        height(height_in),
        options(options_in),
        tiles(*backend, width, height, options),
        global_motion(*backend, width, height),
        reference(tiles.MakeReference()) {}

  TileMeasurement Measure(const GrayImage& frame);
  TileMeasurement MeasureWithPredictions(const GrayImage& frame,
                                         const std::optional<Eigen::Vector2d>& shift);
  bool IsJump(const Eigen::Matrix3d& frame_from_previous) const;
  void StartSegment(const GrayImage& frame, FrameRegistration& registration);
  void MoveReference(const GrayImage& frame, std::uint64_t frame_number);
  void Accept(const GrayImage& frame, const TileMeasurement& measurement,
              FrameRegistration& registration);

  std::shared_ptr<Backend> backend;
  int width;
  int height;
  RegistrationOptions options;
  TileRegistration tiles;
  GlobalMotion global_motion;
  TileReference reference;

  std::uint64_t next_frame_number = 0;
  bool has_reference = false;
  // The reference picture is the anchor in anchor mode, the previous frame in centre mode.
  std::uint64_t reference_number = 0;
  int most_inliers = 0;  // of the registrations to it
  TileMeasurement last;  // kLost where the frame before started a segment
  Eigen::Matrix3d reference_from_previous = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d last_frame_from_previous = Eigen::Matrix3d::Identity();
};

// Predictions in the order of trust: the last motion with the shift that was seen, that shift
// alone, the last motion alone. Each costs a registration, so the next is tried only where one
// leaves doubt; the one on which most tiles agree counts. Where the whole pictures do not confirm
// it, turns and zooms are searched through, and what nothing confirms is not valid.
TileMeasurement StreamRegistration::State::MeasureWithPredictions(
    const GrayImage& frame, const std::optional<Eigen::Vector2d>& shift) {
  const Eigen::Matrix3d previous_from_reference = InverseHomography(reference_from_previous);
  TileMeasurement best;
  const auto attempt = [&](const Eigen::Matrix3d& frame_from_previous) {
    const TileMeasurement measurement =
        tiles.Measure(reference, frame, frame_from_previous * previous_from_reference);
    if (measurement.quality < best.quality ||
        (measurement.quality == best.quality && measurement.inliers > best.inliers)) {
      best = measurement;
    }
    // Few tiles that agree may have settled on something that is not the ground.
    return best.quality == RegistrationQuality::kValid &&
           best.inliers >= kUncontestedShare * best.overlap * best.tiles;
  };
  const auto confirmed = [&] {
    return best.quality == RegistrationQuality::kValid &&
           global_motion.Confirms(InverseHomography(best.reference_from_frame) *
                                  reference_from_previous);
  };
  if (shift) {
    if (attempt(WithCentreShift(last_frame_from_previous, *shift, width, height)) || confirmed()) {
      return best;
    }
    const bool same = last_frame_from_previous.topLeftCorner<2, 2>().isIdentity(1e-4);
    if (!same && attempt(WithCentreShift(Eigen::Matrix3d::Identity(), *shift, width, height))) {
      return best;
    }
  }
  if (attempt(last_frame_from_previous) || confirmed()) return best;
  for (const Eigen::Matrix3d& frame_from_previous : global_motion.SearchTurnsAndZooms()) {
    if (attempt(frame_from_previous) || confirmed()) return best;
  }
  if (best.quality == RegistrationQuality::kValid) best.quality = RegistrationQuality::kDegraded;
  return best;
}

TileMeasurement StreamRegistration::State::Measure(const GrayImage& frame) {
  const auto shift = global_motion.NextShift(frame);
  if (global_motion.Repeats() && last.quality != RegistrationQuality::kLost) {
    // Nothing new is to be learned from it.
    TileMeasurement measurement = last;
    measurement.reference_from_frame = reference_from_previous;
    return measurement;
  }
  TileMeasurement measurement = MeasureWithPredictions(frame, shift);
  if (PredictedError(measurement) > options.refine_above_px) {
    measurement = tiles.Refine(measurement, reference, frame);
  }
  if (PredictedError(measurement) > options.max_error_px &&
      measurement.quality == RegistrationQuality::kValid) {
    measurement.quality = RegistrationQuality::kDegraded;
  }
  return measurement;
}

bool StreamRegistration::State::IsJump(const Eigen::Matrix3d& frame_from_previous) const {
  if (last.quality == RegistrationQuality::kLost) return false;  // no motion to go by
  const Eigen::Vector2d centre(0.5 * (width - 1), 0.5 * (height - 1));
  return (Project(frame_from_previous, centre) - Project(last_frame_from_previous, centre)).norm() >
         kJumpShare * width;
}

void StreamRegistration::State::MoveReference(const GrayImage& frame, std::uint64_t frame_number) {
  tiles.SetReference(frame, reference);
  reference_number = frame_number;
  most_inliers = 0;
  reference_from_previous.setIdentity();
}

void StreamRegistration::State::StartSegment(const GrayImage& frame,
                                             FrameRegistration& registration) {
  MoveReference(frame, registration.frame_number);
  last_frame_from_previous.setIdentity();
  registration.starts_segment = true;
  registration.anchor_number = registration.frame_number;
  registration.tiles = TileCount(options.tile_columns, options.tile_rows, options.tile_layers);
  if (options.reference == ReferenceMode::kAnchor) {
    registration.anchor_from_frame = Eigen::Matrix3d::Identity();
  }
  last = {};
  if (!tiles.HasTexture(reference)) {
    registration.quality = RegistrationQuality::kLost;
    registration.change = FrameChange::kNoTexture;
  }
}

void StreamRegistration::State::Accept(const GrayImage& frame, const TileMeasurement& measurement,
                                       FrameRegistration& registration) {
  const Eigen::Matrix3d& reference_from_frame = measurement.reference_from_frame;
  registration.previous_from_frame =
      InverseHomography(reference_from_previous) * reference_from_frame;
  registration.previous_from_frame /= registration.previous_from_frame(2, 2);
  registration.anchor_number = reference_number;
  registration.corner_covariance = measurement.corner_covariance;
  registration.inliers = measurement.inliers;
  registration.tiles = measurement.tiles;
  registration.residual_px = measurement.residual_px;
  registration.overlap = measurement.overlap;
  registration.quality = measurement.quality;

  const Eigen::Matrix3d frame_from_previous = InverseHomography(registration.previous_from_frame);
  if (global_motion.Repeats()) {
    registration.change = FrameChange::kRepeated;
  } else {
    if (IsJump(frame_from_previous)) registration.change = FrameChange::kJump;
    last_frame_from_previous = frame_from_previous;
  }
  last = measurement;
  reference_from_previous = reference_from_frame;
  const bool anchored = options.reference == ReferenceMode::kAnchor;
  if (anchored) registration.anchor_from_frame = reference_from_frame;
  most_inliers = std::max(most_inliers, measurement.inliers);
  const bool worn = measurement.overlap < options.min_overlap ||
                    measurement.inliers < options.min_agreement * most_inliers ||
                    measurement.quality == RegistrationQuality::kDegraded;
  if (!anchored || worn) {
    MoveReference(frame, registration.frame_number);
  }
}

StreamRegistration::StreamRegistration(std::shared_ptr<Backend> backend, int width, int height,
                                       const RegistrationOptions& options)
    : state_(std::make_unique<State>(std::move(backend), width, height, options)) {}

StreamRegistration::~StreamRegistration() = default;

FrameRegistration StreamRegistration::Register(const GrayImage& frame) {
  State& state = *state_;
  if (frame.width() != state.width || frame.height() != state.height) {
    throw std::invalid_argument("frame size differs from the one given at construction");
  }
  FrameRegistration registration;
  registration.frame_number = state.next_frame_number++;
  if (!std::exchange(state.has_reference, true)) {
    state.global_motion.NextShift(frame);
    state.StartSegment(frame, registration);
    return registration;
  }
  const TileMeasurement measurement = state.Measure(frame);
  if (measurement.quality == RegistrationQuality::kLost) {
    registration.quality = RegistrationQuality::kLost;
    registration.change = FrameChange::kCut;
    state.StartSegment(frame, registration);
    registration.inliers = measurement.inliers;
    return registration;
  }
  state.Accept(frame, measurement, registration);
  return registration;
}

void StreamRegistration::Reset() {
  state_->has_reference = false;
  state_->global_motion.Reset();
}

}  // namespace windhover
