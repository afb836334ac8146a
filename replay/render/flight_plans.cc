// SPDX-License-Identifier: Apache-2.0
#include "replay/render/flight_plan.h"

// Dataset B as thesis A.1 states the motion of its cameras (sequences 1 to 7) and what is hard in
// it, dataset A (thesis 2.4.4), and one sequence beside them.

namespace windhover::replay {
namespace {

FlightPlan Outskirts() {
  FlightPlan plan;
  plan.number = "01";
  plan.name = "outskirts";
  plan.frames = 420;
  plan.traffic_density = 0.3;
  plan.sensor = {.gain = 0.85, .bias = 16};
  return plan;
}

FlightPlan Towers() {
  FlightPlan plan;
  plan.number = "02";
  plan.name = "towers";
  plan.scene = SceneKind::kTowers;
  plan.traffic_density = 0.06;
  plan.width = 720;
  plan.height = 576;
  plan.frames = 380;
  plan.seed = 3;
  plan.frame_rate_hz = 12;
  plan.camera = {.altitude_m = 190,
                 .nominal_width_px = 720,
                 .pixel_m = 0.275,
                 .speed_m = 2.2,
                 .yaw_rate_deg = 0.25,
                 .tilt_deg = 8,
                 .sway_m = 4,
                 .climb_m = 5};
  plan.sensor = {
      .exposure_share = 0.7, .psf_sigma_px = 0.95, .gain = 0.45, .bias = 58, .read_sigma = 2.0};
  plan.traffic_contrast = 3.2;
  return plan;
}

FlightPlan Streets() {
  FlightPlan plan;
  plan.number = "03";
  plan.name = "streets";
  plan.scene = SceneKind::kStreets;
  plan.traffic_density = 0.16;
  plan.frames = 400;
  plan.frame_rate_hz = 15;
  plan.camera = {.altitude_m = 230,
                 .pixel_m = 0.44,
                 .speed_m = 1.7,
                 .yaw_rate_deg = -0.22,
                 .tilt_deg = 5,
                 .sway_m = 6,
                 .climb_m = 6};
  plan.sensor = {.gain = 0.8, .bias = 20, .read_sigma = 2.2};
  plan.traffic_contrast = 1.7;
  return plan;
}

FlightPlan Country() {
  FlightPlan plan;
  plan.number = "04";
  plan.name = "country";
  plan.scene = SceneKind::kCountry;
  plan.frames = 500;
  plan.camera = {.altitude_m = 68,
                 .pixel_m = 0.15,
                 .speed_m = 1.25,
                 .yaw_deg = 90,
                 .yaw_rate_deg = 0,
                 .yaw_wobble_deg = 0.7,
                 .tilt_deg = 38,
                 .sway_m = 2,
                 .climb_m = 1.5,
                 .attitude_wobble_deg = 0.3};
  plan.sensor = {.psf_sigma_px = 0.5, .read_sigma = 2.2};
  return plan;
}

FlightPlan Dunes() {
  FlightPlan plan;
  plan.number = "05";
  plan.name = "dunes";
  plan.scene = SceneKind::kDunes;
  plan.frames = 450;
  plan.camera = {.altitude_m = 340,
                 .pixel_m = 0.6,
                 .speed_m = 3.6,
                 .yaw_deg = 90,
                 .yaw_rate_deg = 0,
                 .yaw_wobble_deg = 0.6,
                 .tilt_deg = 12,
                 .sway_m = 6,
                 .climb_m = 6,
                 .attitude_wobble_deg = 0.2};
  plan.sensor = {.psf_sigma_px = 0.4,
                 .vignetting = 0.12,
                 .gain = 1.0,
                 .bias = 0,
                 .read_sigma = 3.2,
                 .shot_gain = 0.04};
  plan.traffic_density = 0.8;
  return plan;
}

FlightPlan Square() {
  FlightPlan plan;
  plan.number = "06";
  plan.name = "square";
  plan.scene = SceneKind::kSquare;
  plan.traffic_density = 0.05;
  plan.width = 720;
  plan.height = 576;
  plan.frames = 500;
  plan.frame_rate_hz = 15;
  plan.camera = {.kind = PathKind::kHover,
                 .altitude_m = 60,
                 .nominal_width_px = 720,
                 .pixel_m = 0.07,
                 .speed_m = 0,
                 .yaw_rate_deg = 0,
                 .yaw_wobble_deg = 0.35,
                 .tilt_deg = 36,
                 .sway_m = 0.5,
                 .climb_m = 0.3,
                 .attitude_wobble_deg = 0.25,
                 .wobble_period = 45};
  plan.sensor = {.gain = 0.7, .bias = 30, .read_sigma = 2.0};
  plan.traffic_contrast = 2.0;
  return plan;
}

FlightPlan Valley() {
  FlightPlan plan;
  plan.number = "07";
  plan.name = "valley";
  plan.scene = SceneKind::kValley;
  plan.width = 720;
  plan.height = 576;
  plan.frames = 450;
  plan.frame_rate_hz = 12;
  plan.camera = {.altitude_m = 55,
                 .nominal_width_px = 720,
                 .pixel_m = 0.0764,
                 .speed_m = 1.4,
                 .yaw_deg = 90,
                 .yaw_rate_deg = 0.02,
                 .yaw_wobble_deg = 0.8,
                 .tilt_deg = 74,
                 .sway_m = 2,
                 .climb_m = 1.5,
                 .attitude_wobble_deg = 0.3};
  plan.sensor = {.gain = 0.6, .bias = 42, .read_sigma = 2.2};
  plan.traffic_density = 0.29;
  plan.traffic_contrast = 2.6;
  return plan;
}

FlightPlan Harbour() {
  FlightPlan plan;
  plan.number = "08";
  plan.name = "harbour";
  plan.scene = SceneKind::kHarbour;
  plan.frames = 384;
  plan.seed = 3;
  plan.frame_rate_hz = 12;
  plan.camera = {.kind = PathKind::kOrbit,
                 .altitude_m = 200,
                 .pixel_m = 0.25,
                 .radius_m = 180,
                 .orbit_deg = 0.75,
                 .yaw_rate_deg = 0,
                 .yaw_wobble_deg = 1.2,
                 .tilt_deg = 42,
                 .sway_m = 4,
                 .climb_m = 5,
                 .attitude_wobble_deg = 1.1,
                 .wobble_period = 33};
  plan.sensor = {.exposure_share = 0.5,
                 .psf_sigma_px = 0.9,
                 .vignetting = 0.15,
                 .gain = 0.62,
                 .bias = 22,
                 .steps = {{70, 3, 0.56, 24},
                           {150, 2, 0.46, 54},
                           {215, 6, 0.54, 32},
                           {300, 2, 0.64, 16},
                           {345, 4, 0.5, 38}},
                 .read_sigma = 2.8,
                 .shot_gain = 0.02,
                 .grey = true,
                 .column_sigma = 0.6};
  plan.traffic_density = 0.15;
  plan.traffic_contrast = 2.1;
  return plan;
}

FlightPlan Highway() {
  FlightPlan plan;
  plan.number = "09";
  plan.name = "highway";
  plan.scene = SceneKind::kHighway;
  plan.width = 720;
  plan.height = 576;
  plan.frames = 350;
  plan.seed = 2;
  plan.camera = {.altitude_m = 48,
                 .nominal_width_px = 720,
                 .pixel_m = 0.082,
                 .speed_m = 2.0,
                 .yaw_deg = 62,
                 .yaw_rate_deg = 0.05,
                 .yaw_wobble_deg = 2,
                 .tilt_deg = 14,
                 .sway_m = 2,
                 .climb_m = 1.5,
                 .attitude_wobble_deg = 0.5,
                 .zoom = 1.35,
                 .zoom_period = 140};
  plan.sensor = {
      .exposure_share = 0.25, .psf_sigma_px = 1.0, .gain = 0.45, .bias = 58, .read_sigma = 2.0};
  plan.traffic_density = 1.5;
  plan.traffic_contrast = 2;
  return plan;
}

FlightPlan Suburb() {
  FlightPlan plan;
  plan.number = "10";
  plan.name = "suburb";
  plan.scene = SceneKind::kSuburb;
  plan.frames = 350;
  plan.frame_rate_hz = 15;
  plan.camera = {.altitude_m = 240,
                 .pixel_m = 0.31,
                 .heading_deg = 8,
                 .speed_m = 2.4,
                 .yaw_deg = 98,
                 .yaw_rate_deg = 0,
                 .yaw_wobble_deg = 1.5,
                 .tilt_deg = 10,
                 .sway_m = 5,
                 .climb_m = 5,
                 .attitude_wobble_deg = 0.5,
                 .jitter_px = 3};
  plan.sensor = {.exposure_share = 0.5,
                 .vignetting = 0.15,
                 .gain = 0.55,
                 .bias = 46,
                 .read_sigma = 2.0,
                 .quantiser = 31};
  plan.traffic_density = 0.34;
  plan.traffic_contrast = 1.4;
  return plan;
}

FlightPlan Interchange() {
  FlightPlan plan;
  plan.number = "s1";
  plan.name = "interchange";
  plan.scene = SceneKind::kInterchange;
  plan.traffic_density = 0.5;
  plan.frames = 300;
  plan.camera = {.altitude_m = 210,
                 .pixel_m = 0.36,
                 .speed_m = 0.5,
                 .yaw_rate_deg = 0.25,
                 .tilt_deg = 8,
                 .sway_m = 6,
                 .climb_m = 5,
                 .zoom = 1.15,
                 .zoom_period = 220};
  return plan;
}

// Dataset A: what the ground looks like differs, the cameras fly alike.
FlightPlan Registration(const char* number, SceneKind scene, std::uint64_t seed) {
  FlightPlan plan;
  plan.number = number;
  plan.name = std::string("registration-") + number;
  plan.scene = scene;
  plan.frames = 200;
  plan.seed = seed;
  return plan;
}

FlightPlan A1() {
  FlightPlan plan = Registration("a1", SceneKind::kOutskirts, 21);
  plan.camera.speed_m = 1.4;
  plan.camera.yaw_rate_deg = -0.4;
  return plan;
}

FlightPlan A2() {
  FlightPlan plan = Registration("a2", SceneKind::kCountry, 22);
  plan.camera = {.altitude_m = 150,
                 .pixel_m = 0.25,
                 .speed_m = 1.6,
                 .yaw_deg = 40,
                 .yaw_rate_deg = 0.15,
                 .tilt_deg = 10};
  return plan;
}

FlightPlan A3() {
  FlightPlan plan = Registration("a3", SceneKind::kSuburb, 23);
  plan.width = 720;
  plan.height = 576;
  plan.camera = {.altitude_m = 200,
                 .nominal_width_px = 720,
                 .pixel_m = 0.3,
                 .speed_m = 1.8,
                 .yaw_rate_deg = 0.3,
                 .zoom = 1.2,
                 .zoom_period = 160};
  return plan;
}

FlightPlan A4() {
  FlightPlan plan = Registration("a4", SceneKind::kOutskirts, 24);
  plan.width = 720;
  plan.height = 576;
  plan.camera = {.altitude_m = 160,
                 .nominal_width_px = 720,
                 .pixel_m = 0.27,
                 .heading_deg = 20,
                 .speed_m = 2.2,
                 .yaw_deg = -35,
                 .yaw_rate_deg = 0.1,
                 .tilt_deg = 12};
  return plan;
}

}  // namespace

const std::vector<FlightPlan>& FlightPlans() {
  static const std::vector<FlightPlan> plans = {
      Outskirts(), Towers(), Streets(), Country(), Dunes(), Square(), Valley(),     Harbour(),
      Highway(),   Suburb(), A1(),      A2(),      A3(),    A4(),     Interchange()};
  return plans;
}

}  // namespace windhover::replay
