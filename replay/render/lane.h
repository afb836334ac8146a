// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "replay/render/path.h"

namespace windhover::replay {

// How high a way lies: linear between knots, which come in order, level before the first and after
// the last.
struct HeightKnot {
  double at_m = 0.0;
  double height_m = 0.0;
};
double HeightOfWay(const std::vector<HeightKnot>& knots, double along);

// A line that vehicles follow one behind the other, with the lights and stops on its way. Vehicles
// brake before bends, before red lights and behind whatever is in their way, also of other lanes.
struct Lane {
  struct Light {
    double at_m = 0.0;          // stop line, along the path
    double period_s = 12.0;     // green from `green_from_s` on for `green_s`, then red
    double green_from_s = 0.0;  // may be negative
    double green_s = 6.0;
  };
  // Where some drivers halt for a while: a bus stop, a gate, a turn across the other lane.
  struct Stop {
    double at_m = 0.0;
    double seconds = 4.0;
    double share = 1.0;  // of the drivers
  };
  // How high the way lies; for bridges.
  using Knot = HeightKnot;
  Path path;
  double right_m = 0.0;   // lateral place of the lane
  double spacing_m = 30;  // mean distance between vehicles
  double speed_low = 8;   // m/s, range of the speeds that drivers want
  double speed_high = 16;
  std::vector<Light> lights;
  std::vector<Stop> stops;
  std::vector<Knot> knots;

  // At a place along the path, m.
  double HeightAt(double along) const { return HeightOfWay(knots, along); }
};

// A line along which people walk to and fro, alone and in groups; they stop now and then.
struct Walk {
  Path path;
  double width_m = 3.0;    // how far from the line they spread
  int groups = 4;          // of one to four people
  double speed_low = 0.8;  // m/s
  double speed_high = 1.6;
};

}  // namespace windhover::replay
