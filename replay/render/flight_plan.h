// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace windhover::replay {

// Where the camera flies and how it is held. Times are frames. Each wobble is a sum of three slow
// sines whose phases follow from the seed.
struct CameraPlan {
  double altitude_m = 120.0;
  // Over a picture this wide the ground is `pixel_m` a pixel; other widths keep the field of view.
  int nominal_width_px = 640;
  double pixel_m = 0.22;
  // Straight flight along the map's x axis.
  double speed_m = 1.0;  // a frame
  double start_x_m = 0.0;
  double yaw_rate_deg = 0.3;  // a frame
  double tilt_deg = 3.0;      // mean pitch away from straight down
  double sway_m = 3.0;        // amplitude of the wobble across the way
  double climb_m = 4.0;       // amplitude of the height's wobble
  double attitude_wobble_deg = 0.25;
  double wobble_period = 37.0;  // frames; of the fastest sine
};

struct SensorPlan {
  double exposure_share = 0.3;  // of the time between two frames
  double psf_sigma_px = 0.45;   // optics, beside the pixel's own square
  // Noise variance in grey levels squared: read_sigma^2 + shot_gain * value.
  double read_sigma = 1.7;
  double shot_gain = 0.03;
  double chroma_sigma = 1.2;  // of each colour, beside the noise that all three share
};

// Which world lies below: each kind has its own builder.
enum class SceneKind { kOutskirts };

// Everything that a rendered sequence follows from.
struct FlightPlan {
  std::string number;  // "01": the sequence's folder in a dataset
  std::string name;    // "outskirts"
  SceneKind scene = SceneKind::kOutskirts;
  int width = 640;
  int height = 480;
  int frames = 240;
  double frame_rate_hz = 25.0;
  std::uint64_t seed = 1;
  CameraPlan camera;
  SensorPlan sensor;
};

// The flights there are, in order.
const std::vector<FlightPlan>& FlightPlans();

// By number with or without leading zeros, by name, or "flight" for the first one. Throws
// std::invalid_argument that names what there is.
FlightPlan FindFlightPlan(const std::string& name);

}  // namespace windhover::replay
