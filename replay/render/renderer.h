// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "replay/format/labels.h"
#include "replay/render/camera.h"
#include "replay/render/flight_plan.h"
#include "replay/render/land.h"
#include "replay/render/scene.h"
#include "replay/render/sensor.h"
#include "replay/render/traffic.h"
#include "replay/render/view.h"

namespace windhover::replay {

// What is true about one rendered frame.
struct FrameTruth {
  // Ground at height 0: pixels of the frame to pixels of frame 0. Both cameras are in the mean pose
  // of their exposures, about which the picture is blurred; a camera that shakes is not there at
  // the middle of the exposure.
  Eigen::Matrix3d first_from_frame = Eigen::Matrix3d::Identity();
  // The ground lies where a u + b v + c > 0; (a, b) has unit length, or is 0 where the camera looks
  // straight down.
  Eigen::Vector3d horizon = Eigen::Vector3d::UnitZ();
  // Vehicles and people that move, by kMoverTravelPx below; at least kLeastVisible of them seen and
  // the box at least kLeastWidthPx wide and high. The box is the tightest around the pixels that
  // are seen. Those of which less is seen, but kLeastMarked, are there with score 0: they do not
  // count.
  std::vector<LabelledBox> movers;
  // Vehicles that do not, parked or waiting, by the same rules. Their ids never meet those of
  // movers unless it is the same vehicle.
  std::vector<LabelledBox> decoys;
};

// A vehicle moves in a frame where its way in the kMoverWindowFrames around that frame, all of it
// seen by the camera of that frame, is at least kMoverTravelPx long in the picture.
inline constexpr int kMoverWindowFrames = 10;
inline constexpr double kMoverTravelPx = 2.0;
inline constexpr double kLeastVisible = 0.4;
inline constexpr double kLeastMarked = 0.1;
inline constexpr int kLeastWidthPx = 3;

// Renders the frames of one flight. The picture and the truth of a frame follow from the plan
// alone, to the bit, whatever is asked for in whatever order and on however many threads.
class Renderer {
 public:
  // Paints the land on `threads` threads; takes some seconds. Meanwhile `go_on` is called now and
  // then, from any of them; what it throws ends the work and comes out here. Only the first
  // `frames` of the flight may be asked for, which makes short runs quick; 0: all of them. The plan
  // must make sense: std::invalid_argument for sizes under 16 px, no frames and more than the
  // flight has.
  Renderer(const FlightPlan& plan, int threads, const std::function<void()>& go_on = {},
           int frames = 0);

  const FlightPlan& plan() const { return plan_; }
  // Thread-safe. `frame` from 0; CV_8UC3, blue first. The vehicle `without` is left out, but not
  // its shadow: for holding boxes against pictures.
  cv::Mat Frame(int frame, std::int64_t without = 0) const;
  FrameTruth Truth(int frame) const;
  // FrameTruth::first_from_frame alone, which takes no time.
  Eigen::Matrix3d TrueHomography(int frame) const;

  // Share of the pixels that see land in `frame` and lie `gap` frames later more than `px` away
  // from where the ground's homography puts them; vehicles left out. For guarding the difficulty.
  double OffPlaneShare(int frame, int gap, double px) const;

 private:
  std::vector<DrawnBody> BodiesAt(double time) const;
  void AddBody(std::int64_t id, const VehicleLook& look, VehiclePose pose, const Camera& camera,
               std::vector<DrawnBody>& bodies) const;
  double Seconds(double time) const { return time / plan_.frame_rate_hz; }
  Camera TrueCamera(int frame) const;
  bool Moves(const Traffic::Vehicle& vehicle, int frame) const;

  FlightPlan plan_;
  Scene scene_;
  CameraPath camera_path_;
  Traffic traffic_;
  Land land_;
  Sensor sensor_;
};

}  // namespace windhover::replay
