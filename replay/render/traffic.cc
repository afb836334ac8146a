// SPDX-License-Identifier: Apache-2.0
#include "replay/render/traffic.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "replay/render/portable_math.h"

namespace windhover::replay {
namespace {

constexpr double kAcceleration = 2.2;  // m/s^2
constexpr double kBraking = 2.8;       // m/s^2, comfortable
constexpr double kHardBraking = 8.0;   // m/s^2, the most there is
constexpr double kHeadway = 1.1;       // s
constexpr double kStandingGap = 2.2;   // m
constexpr double kSettleSeconds = 14;  // before the first frame

struct Driver {
  double along = 0.0;
  double speed = 0.0;
  double wanted = 0.0;
};

double Acceleration(const Driver& driver, double gap, double closing) {
  const double ratio = driver.speed / driver.wanted;
  const double free = 1 - ratio * ratio * ratio * ratio;
  const double brake = driver.speed * closing / (2 * std::sqrt(kAcceleration * kBraking));
  const double desired = kStandingGap + std::max(0.0, driver.speed * kHeadway + brake);
  const double near = desired / std::max(gap, 0.1);
  return std::max(kAcceleration * (free - near * near), -kHardBraking);
}

bool IsRed(const Lane::Light& light, double time_s) {
  const double since = time_s - light.green_from_s;
  const double phase = since - light.period_s * std::floor(since / light.period_s);
  return phase >= light.green_s;
}

// Distance to the next red light at which the driver can still stop.
double GapToLight(const Lane& lane, const Driver& driver, double front, double time_s) {
  double gap = std::numeric_limits<double>::infinity();
  for (const Lane::Light& light : lane.lights) {
    const double ahead = light.at_m - front;
    const double stopping = driver.speed * driver.speed / (2 * kHardBraking * 0.6);
    if (ahead > stopping && ahead < gap && IsRed(light, time_s)) gap = ahead;
  }
  return gap;
}

}  // namespace

Traffic::Traffic(const Scene& scene, int frames, double frame_rate_hz)
    : lanes_(scene.lanes), seed_(scene.seed) {
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    FillLane(lane, frames + 2 * kMarginFrames + 1, 1 / frame_rate_hz);
  }
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    vehicles_[i].id = static_cast<std::int64_t>(i) + 1;
  }
}

void Traffic::FillLane(std::size_t index, int steps, double frame_s) {
  const Lane& lane = lanes_[index];
  Random random(Mix(seed_, 0x7AF1C + index));
  const double run_in = kSettleSeconds * lane.speed_high;
  std::vector<Driver> drivers;  // the foremost first
  const std::size_t first = vehicles_.size();
  for (double at = lane.path.length(); at > -run_in;
       at -= std::max(10.0, lane.spacing_m * random.Uniform(0.4, 1.6))) {
    const double wanted = random.Uniform(lane.speed_low, lane.speed_high);
    drivers.push_back({at, 0.8 * wanted, wanted});
    vehicles_.push_back({0, RandomVehicle(random), index, {}});
  }
  const int settle = static_cast<int>(kSettleSeconds / frame_s);
  std::vector<double> pushes(drivers.size());
  for (int step = -settle; step < steps; ++step) {
    const double time_s = (step - kMarginFrames) * frame_s;
    for (std::size_t i = 0; i < drivers.size(); ++i) {
      const VehicleLook& look = vehicles_[first + i].look;
      const double front = drivers[i].along + look.length / 2;
      double push =
          Acceleration(drivers[i], GapToLight(lane, drivers[i], front, time_s), drivers[i].speed);
      if (i > 0) {
        const double rear = drivers[i - 1].along - vehicles_[first + i - 1].look.length / 2;
        push = std::min(
            push, Acceleration(drivers[i], rear - front, drivers[i].speed - drivers[i - 1].speed));
      }
      pushes[i] = push;
    }
    for (std::size_t i = 0; i < drivers.size(); ++i) {
      if (step >= 0) vehicles_[first + i].along.push_back(static_cast<float>(drivers[i].along));
      drivers[i].speed = std::max(0.0, drivers[i].speed + pushes[i] * frame_s);
      drivers[i].along += drivers[i].speed * frame_s;
    }
  }
}

VehiclePose Traffic::PoseAt(const Vehicle& vehicle, double time) const {
  const double step = time + kMarginFrames;
  const auto last = static_cast<double>(vehicle.along.size() - 1);
  const double before = std::clamp(std::floor(step), 0.0, last - 1);
  const auto i = static_cast<std::size_t>(before);
  const double along =
      vehicle.along[i] + (step - before) * (vehicle.along[i + 1] - vehicle.along[i]);
  const Lane& lane = lanes_[vehicle.lane];
  const Path::Place here = lane.path.At(along, lane.right_m);
  // The heading of a body on two axles, which also smooths the corners of the path.
  const Path::Place ahead = lane.path.At(along + 2.5, lane.right_m);
  const Path::Place behind = lane.path.At(along - 2.5, lane.right_m);
  return {here.position, (ahead.position - behind.position).normalized()};
}

}  // namespace windhover::replay
