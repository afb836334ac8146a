// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/speed_setup.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "gpu-kernels/backend.h"
#include "replay/render/parallel.h"

namespace windhover::replay {

std::string SizeText(const SpeedSize& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void Check(const SpeedBenchmarkSettings& settings) {
  for (const SpeedSize& size : settings.sizes) {
    const int frames = &size == &settings.sizes.front()
                           ? std::min(size.frames, settings.centre_frames)
                           : size.frames;
    if (frames <= kPipelineWarmUp + kFramesOnTheWay || size.width % 2 != 0 ||
        size.height % 2 != 0) {
      throw std::invalid_argument("the benchmark needs even frame sizes and more than " +
                                  std::to_string(kPipelineWarmUp + kFramesOnTheWay) + " frames");
    }
  }
}

SpeedFlight RenderSpeedFlight(const std::string& sequence, const SpeedSize& size, int threads,
                              const BenchmarkProgress& progress) {
  FlightPlan plan = FindFlightPlan(sequence);
  plan.width = size.width;
  plan.height = size.height;
  progress.say("rendering sequence " + plan.number + ", " + SizeText(size) + ", " +
               std::to_string(size.frames) + " frames");
  const Renderer renderer(plan, threads, progress.check, size.frames);
  SpeedFlight flight = {size.width, size.height, plan.frame_rate_hz, {}, {}};
  flight.i420.resize(size.frames);
  flight.truth.resize(size.frames);
  ForEachInParallel(size.frames, threads, [&](int i) {
    progress.check();
    cv::cvtColor(renderer.Frame(i), flight.i420[i], cv::COLOR_BGR2YUV_I420);
    flight.truth[i] = renderer.Truth(i);
  });
  return flight;
}

SpeedDevices DevicesToTime() {
  const DeviceInfo by_default = Backend::Create()->device();
  SpeedDevices found;
  found.by_default = by_default.Describe();
  found.opencl = "none";
  for (const DeviceInfo& device : Backend::Devices()) {
    const bool is_default = device.selector == by_default.selector;
    if (device.kind == DeviceKind::kCpuTwin) {
      found.devices.push_back({"cpu", "cpu"});
    } else if (found.opencl == "none" && (is_default || by_default.kind == DeviceKind::kCpuTwin)) {
      found.devices.push_back({"opencl", device.selector});
      found.opencl = device.Describe();
    } else {
      continue;
    }
    if (is_default) std::swap(found.devices.front(), found.devices.back());
  }
  if (found.opencl == "none") found.left_out.emplace_back("there is no OpenCL device");
  return found;
}

}  // namespace windhover::replay
