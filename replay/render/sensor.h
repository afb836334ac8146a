// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "replay/render/flight_plan.h"

namespace windhover::replay {

// From the light that falls on each pixel to 8 bits: vignetting, point spread, exposure, shot and
// read noise, rounding. Light and noise are counted in grey levels; there is no tone curve between.
class Sensor {
 public:
  Sensor(const SensorPlan& plan, std::uint64_t seed);

  // `light` is CV_32FC3 and is used up; returns CV_8UC3, blue first. The noise follows from the
  // seed and the frame's number.
  cv::Mat Expose(cv::Mat& light, int frame) const;

  struct Exposure {
    double gain;
    double bias;
  };
  // Grey levels become gain * light + bias in a frame.
  Exposure ExposureAt(double frame) const;

 private:
  void Spread(cv::Mat& light) const;
  // What each column adds in every frame.
  std::vector<float> ColumnLevels(int width) const;

  SensorPlan plan_;
  std::uint64_t seed_;
  std::vector<float> kernel_;  // weights of the pixel itself and its neighbours to one side
};

}  // namespace windhover::replay
