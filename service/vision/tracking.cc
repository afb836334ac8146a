// SPDX-License-Identifier: Apache-2.0
#include "service/vision/tracking.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <tuple>

namespace windhover {
namespace {

// How far a candidate may lie from where its track is expected: so much for any object, px, ...
constexpr double kGatePx = 3.0;
// ... this share of the object's longer side, because its seeds do not always cover all of it, ...
constexpr double kGateOfSize = 0.5;
// ... and this much for each frame without a candidate, as a share of the largest speed.
constexpr double kGateOfSpeed = 0.25;
// Share of the distance between expected and measured that is corrected.
constexpr double kPositionGain = 0.6;
constexpr double kVelocityGain = 0.2;
constexpr double kMeasuredVelocityGain = 0.4;
constexpr double kSizeGain = 0.3;
constexpr double kConfidenceGain = 0.3;
// Way that an object must make in units of its own shorter side, beside min_travel_px.
constexpr double kTravelOfSize = 0.25;

Eigen::Vector2d Centre(const Box& box) {
  return {box.x + 0.5 * (box.width - 1.0), box.y + 0.5 * (box.height - 1.0)};
}

}  // namespace

Tracking::Tracking(const TrackingSettings& settings) : settings_(settings) {}

void Tracking::Reset() { tracks_.clear(); }

const std::vector<Detection>& Tracking::Update(const FrameRegistration& registration,
                                               const std::vector<MotionCandidate>& candidates) {
  if (registration.starts_segment || registration.quality == RegistrationQuality::kLost) Reset();
  Predict(registration.previous_from_frame);
  Assign(candidates);

  detections_.clear();
  for (Track& track : tracks_) {
    if (!track.matched) continue;
    if (track.id == 0 && Confirmed(track)) track.id = next_id_++;
    if (track.id != 0) detections_.push_back(Report(track));
  }
  std::erase_if(tracks_, [&](const Track& track) {
    // Before it is reported, a track must be seen more often than it is missed.
    return track.missed_frames > settings_.max_coast_frames ||
           (track.id == 0 && track.missed_frames >= track.seen_frames);
  });
  return detections_;
}

// Carries the tracks to the new frame over the ground, and on by their velocity.
void Tracking::Predict(const Eigen::Matrix3d& previous_from_frame) {
  const Eigen::Matrix3d frame_from_previous = previous_from_frame.inverse();
  const auto carry = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return (frame_from_previous * x.homogeneous()).hnormalized();
  };
  for (Track& track : tracks_) {
    track.velocity = carry(track.centre + track.velocity) - carry(track.centre);
    track.centre = carry(track.centre) + track.velocity;
    track.origin = carry(track.origin);
    track.matched = false;
  }
}

void Tracking::Assign(const std::vector<MotionCandidate>& candidates) {
  pairs_.clear();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    const double gate = kGatePx + kGateOfSize * track.size.maxCoeff() +
                        kGateOfSpeed * settings_.max_speed_px * (1 + track.missed_frames);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const double distance = (Centre(candidates[c].box) - track.centre).norm();
      if (!(distance < gate)) continue;
      // Reported tracks have the first choice.
      const double cost = distance / gate + (track.id == 0 ? 1.0 : 0.0);
      pairs_.push_back({cost, static_cast<int>(t), static_cast<int>(c)});
    }
  }
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.cost, a.track, a.candidate) < std::tie(b.cost, b.track, b.candidate);
  });
  taken_.assign(candidates.size(), false);
  for (const Pair& pair : pairs_) {
    Track& track = tracks_[pair.track];
    if (track.matched || taken_[pair.candidate]) continue;
    taken_[pair.candidate] = true;
    Correct(track, candidates[pair.candidate]);
  }
  for (Track& track : tracks_) {
    if (!track.matched) ++track.missed_frames;
  }
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (!taken_[c]) Start(candidates[c]);
  }
}

void Tracking::Start(const MotionCandidate& candidate) {
  Track track;
  track.centre = Centre(candidate.box);
  track.velocity = candidate.velocity_px;
  track.size = {candidate.box.width, candidate.box.height};
  track.box = candidate.box;
  track.origin = track.centre;
  track.seen_frames = 1;
  track.confidence = candidate.confidence;
  track.matched = true;
  tracks_.push_back(track);
}

void Tracking::Correct(Track& track, const MotionCandidate& candidate) const {
  const Eigen::Vector2d innovation = Centre(candidate.box) - track.centre;
  track.centre += kPositionGain * innovation;
  if (candidate.has_velocity) {
    track.velocity += kMeasuredVelocityGain * (candidate.velocity_px - track.velocity);
  } else {
    track.velocity += kVelocityGain * innovation / (1 + track.missed_frames);
  }
  track.size +=
      kSizeGain * (Eigen::Vector2d(candidate.box.width, candidate.box.height) - track.size);
  track.box = candidate.box;
  track.confidence += kConfidenceGain * (candidate.confidence - track.confidence);
  ++track.seen_frames;
  track.missed_frames = 0;
  track.matched = true;
}

// Net displacement, so that jitter does not add up.
bool Tracking::Confirmed(const Track& track) const {
  if (track.seen_frames < settings_.min_track_frames) return false;
  if (settings_.min_travel_px <= 0) return true;
  const double travel = (track.centre - track.origin).norm();
  return travel >= std::max(settings_.min_travel_px, kTravelOfSize * track.size.minCoeff());
}

Detection Tracking::Report(const Track& track) const {
  Detection detection;
  detection.track_id = track.id;
  detection.box = track.box;
  detection.velocity_px = track.velocity;
  detection.age_frames = track.seen_frames;
  // A track that has been seen n frames is trusted as n / (n + 2).
  detection.score =
      std::clamp(track.confidence, 0.0, 1.0) * track.seen_frames / (track.seen_frames + 2.0);
  return detection;
}

}  // namespace windhover
