// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "service/vision/types.h"

namespace windhover {

// A thing that the filters say moves, in one frame: what tracks are made of.
struct MotionCandidate {
  Box box;                                                // frame coordinates
  Eigen::Vector2d velocity_px = Eigen::Vector2d::Zero();  // over the ground, frame axes
  bool has_velocity = false;                              // whether that was measured
  double confidence = 0.0;                                // 0 to 1
};

struct TrackingSettings {
  double max_speed_px = 0.0;  // px a frame over the ground
  // Way over the ground before a track is reported, and a quarter of its box's shorter side at
  // least; 0 asks for none.
  double min_travel_px = 0.0;
  int min_track_frames = 1;  // candidates that a track must have had before it is reported
  int max_coast_frames = 0;  // frames that a track survives without a candidate
};

// Tracks with ids that stay: each track's state is carried from frame to frame over the ground by
// the frame's registration, moved on at constant velocity, and given the candidate that fits it
// best. Candidates are assigned greedily in order of cost (distance in units of the gate), which
// equals the optimal assignment as long as gates of neighbouring objects do not overlap.
class Tracking {
 public:
  explicit Tracking(const TrackingSettings& settings);

  // The reported tracks that have a candidate in this frame. Frames must come in order. A frame
  // that starts a segment or is lost ends all tracks before it.
  const std::vector<Detection>& Update(const FrameRegistration& registration,
                                       const std::vector<MotionCandidate>& candidates);

  // Ends all tracks. Ids go on.
  void Reset();

 private:
  struct Track {
    std::uint64_t id = 0;  // 0 until it is reported
    Eigen::Vector2d centre;
    Eigen::Vector2d velocity;
    Eigen::Vector2d size;
    Box box;  // of the last candidate
    // Where on the ground the track was first seen, in coordinates of the current frame.
    Eigen::Vector2d origin;
    int seen_frames = 0;
    int missed_frames = 0;
    double confidence = 0.0;
    bool matched = false;
  };
  struct Pair {
    double cost;
    int track;
    int candidate;
  };

  void Predict(const Eigen::Matrix3d& previous_from_frame);
  void Assign(const std::vector<MotionCandidate>& candidates);
  void Start(const MotionCandidate& candidate);
  void Correct(Track& track, const MotionCandidate& candidate) const;
  bool Confirmed(const Track& track) const;
  Detection Report(const Track& track) const;

  TrackingSettings settings_;
  std::uint64_t next_id_ = 1;
  std::vector<Track> tracks_;
  std::vector<Pair> pairs_;
  std::vector<bool> taken_;
  std::vector<Detection> detections_;
};

}  // namespace windhover
