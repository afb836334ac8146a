// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace windhover::replay {

enum class PathKind {
  kStraight,  // along the heading
  kOrbit,     // round the start, the picture's top towards it
  kHover      // about the start
};

// Where the camera flies and how it is held. Times are frames. Each wobble is a sum of three slow
// sines whose phases follow from the seed.
struct CameraPlan {
  PathKind kind = PathKind::kStraight;
  double altitude_m = 120.0;
  // Over a picture this wide the ground straight below is `pixel_m` a pixel; other widths keep the
  // field of view.
  int nominal_width_px = 640;
  double pixel_m = 0.22;
  double start_x_m = 0.0;
  double start_y_m = 0.0;
  double heading_deg = 0.0;  // straight: way over the map, 0 along x, 90 along y
  double speed_m = 1.0;      // straight: a frame
  double radius_m = 0.0;     // orbit
  double orbit_deg = 0.0;    // orbit: angle at the centre, a frame
  // Direction of the picture's right side: on the map, as heading_deg; on an orbit from where the
  // picture's top points to the centre.
  double yaw_deg = 0.0;
  double yaw_rate_deg = 0.3;    // a frame
  double yaw_wobble_deg = 1.2;  // amplitude
  double tilt_deg = -3.0;       // mean of the axis from straight down towards the picture's top
  double sway_m = 3.0;          // amplitude across the way; hovering: in both directions
  double climb_m = 4.0;         // amplitude of the height's wobble
  double attitude_wobble_deg = 0.25;
  double wobble_period = 37.0;  // frames; of the fastest sine
  // The focal length swings between its own and `zoom` times that, and back, in a period.
  double zoom = 1.0;
  double zoom_period = 300.0;  // frames
  // Vibration of the picture: amplitude in nominal pixels, in periods of one to four frames.
  double jitter_px = 0.0;
};

// The exposure control answers to the light: from `frame` on, within `over` frames, the grey levels
// become gain * light + bias.
struct ExposureStep {
  double frame = 0.0;
  double over = 1.0;
  double gain = 1.0;
  double bias = 0.0;
};

struct SensorPlan {
  double exposure_share = 0.3;  // of the time between two frames
  double psf_sigma_px = 0.75;   // optics and the coding of colours, beside the pixel's own square
  double vignetting = 0.0;      // share of the light that the corners lose
  double gain = 1.0;            // grey levels: gain * light + bias, until the first step
  double bias = 0.0;
  std::vector<ExposureStep> steps{};  // in order of time, none before the one before has ended
  // Noise variance in grey levels squared: read_sigma^2 + shot_gain * value.
  double read_sigma = 1.7;
  double shot_gain = 0.03;
  double chroma_sigma = 1.2;  // of each colour, beside the noise that all three share
  bool grey = false;          // one channel, shown three times; no chroma noise then
  double column_sigma = 0.0;  // grey levels by which columns differ for good (night sensors)
  int quantiser = 0;          // of H.264 compression, 1 (best) to 51; 0: none
};

// Which world lies below: each kind has its own builder.
enum class SceneKind {
  kOutskirts,
  kTowers,
  kStreets,
  kCountry,
  kDunes,
  kSquare,
  kValley,
  kHarbour,
  kHighway,
  kSuburb,
  kInterchange,
};

// Everything that a rendered sequence follows from.
struct FlightPlan {
  std::string number;  // "01": the sequence's folder in a dataset
  std::string name;    // "outskirts"
  SceneKind scene = SceneKind::kOutskirts;
  int width = 640;
  int height = 480;
  // Length of the flight. The world is made for it: a part of a flight has this of the whole.
  int frames = 240;
  double frame_rate_hz = 25.0;
  std::uint64_t seed = 1;
  double traffic_density = 1.0;  // vehicles and people for each that the scene has by itself
  // How many times as far from asphalt as in the palette paint and clothes are; in a thermal scene,
  // the warmth of bodies from that of the ground.
  double traffic_contrast = 1.0;
  // What the ground looks like instead of what the scene paints, and its size on the map; empty:
  // as the scene has it. CV_8UC3, blue first.
  cv::Mat ground;
  double ground_pixel_m = 0.05;
  CameraPlan camera;
  SensorPlan sensor;
};

// The flights there are, in order: 01 to 10, then those beside the ten.
const std::vector<FlightPlan>& FlightPlans();

// By number with or without leading zeros, by name, or "flight" for the first one. Throws
// std::invalid_argument that names what there is.
FlightPlan FindFlightPlan(const std::string& name);

// Several, separated by commas; "all" stands for the ten. Throws as FindFlightPlan and where one is
// named twice.
std::vector<FlightPlan> FindFlightPlans(const std::string& names);

}  // namespace windhover::replay
