// SPDX-License-Identifier: Apache-2.0
#include "replay/render/drivers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "replay/render/portable_math.h"

namespace windhover::replay {

double HeightOfWay(const std::vector<HeightKnot>& knots, double along) {
  if (knots.empty()) return 0.0;
  if (along <= knots.front().at_m) return knots.front().height_m;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    if (along >= knots[i].at_m) continue;
    const double share = (along - knots[i - 1].at_m) / (knots[i].at_m - knots[i - 1].at_m);
    return knots[i - 1].height_m + share * (knots[i].height_m - knots[i - 1].height_m);
  }
  return knots.back().height_m;
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAcceleration = 2.2;  // m/s^2
constexpr double kBraking = 2.8;       // m/s^2, comfortable
constexpr double kHardBraking = 8.0;   // m/s^2, the most there is
constexpr double kSidewards = 2.6;     // m/s^2, in a bend
constexpr double kHeadway = 1.1;       // s
constexpr double kStandingGap = 2.2;   // m
constexpr double kSideGap = 0.4;       // m, that one dares to pass with
constexpr double kHeadroom = 3.0;      // m, from which on one way leads over another
constexpr double kLimitStep = 2.0;     // m, between places with a known speed limit

bool IsRed(const Lane::Light& light, double time_s) {
  const double since = time_s - light.green_from_s;
  const double phase = since - light.period_s * std::floor(since / light.period_s);
  return phase >= light.green_s;
}

// Speeds that the bends of a lane allow every kLimitStep metres, m/s; known early enough to brake.
std::vector<double> SpeedLimits(const Lane& lane) {
  constexpr double kReach = 4.0;  // m, over which a bend is measured
  std::vector<double> limits(static_cast<std::size_t>(lane.path.length() / kLimitStep) + 2);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double at = static_cast<double>(i) * kLimitStep;
    const Eigen::Vector2d before = lane.path.At(at - kReach).forward;
    const Eigen::Vector2d after = lane.path.At(at + kReach).forward;
    const double bend = (after - before).norm() / (2 * kReach);
    limits[i] = std::max(2.5, std::sqrt(kSidewards / std::max(bend, 1e-4)));
  }
  for (std::size_t i = limits.size() - 1; i-- > 0;) {
    const double next = limits[i + 1];
    limits[i] = std::min(limits[i], std::sqrt(next * next + 2 * 0.6 * kBraking * kLimitStep));
  }
  return limits;
}

struct Driver {
  std::size_t lane = 0;
  VehicleLook look;
  double along = 0.0;  // m, of the vehicle's middle
  double speed = 0.0;  // m/s
  double wanted = 0.0;
  std::vector<std::size_t> halts;  // of the lane's stops, those ahead, the next one last
  double halting_s = 0.0;
  VehiclePose pose;
  double push = 0.0;  // m/s^2

  double front() const { return along + look.length / 2; }
};

class Roads {
 public:
  Roads(const std::vector<Lane>& lanes, double density, std::uint64_t seed, double run_in_s)
      : lanes_(lanes) {
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
      limits_.push_back(SpeedLimits(lanes_[lane]));
      Fill(lane, density, seed, run_in_s);
    }
    for (Driver& driver : drivers_) driver.pose = PoseOf(driver);
  }

  const std::vector<Driver>& drivers() const { return drivers_; }

  void Step(double time_s, double frame_s) {
    for (Driver& driver : drivers_) driver.push = Push(driver, time_s);
    for (Driver& driver : drivers_) {
      driver.speed = std::max(0.0, driver.speed + driver.push * frame_s);
      driver.along += driver.speed * frame_s;
      Halt(driver, frame_s);
      driver.pose = PoseOf(driver);
    }
  }

 private:
  void Fill(std::size_t index, double density, std::uint64_t seed, double run_in_s) {
    const Lane& lane = lanes_[index];
    Random random(Mix(seed, 0x7AF1C + index));
    for (double at = lane.path.length(); at > -run_in_s * lane.speed_high;
         at -= std::max(12.0, lane.spacing_m / density * random.Uniform(0.4, 1.6))) {
      Driver driver;
      driver.lane = index;
      driver.look = RandomVehicle(random);
      driver.along = at;
      driver.wanted = random.Uniform(lane.speed_low, lane.speed_high);
      driver.speed = 0.8 * driver.wanted;
      for (std::size_t stop = lane.stops.size(); stop-- > 0;) {
        const bool halts = random.Chance(lane.stops[stop].share);
        if (halts && lane.stops[stop].at_m > driver.front()) driver.halts.push_back(stop);
      }
      drivers_.push_back(driver);
    }
  }

  VehiclePose PoseOf(const Driver& driver) const {
    const Lane& lane = lanes_[driver.lane];
    // The heading of a body on two axles, which also smooths the corners of the path.
    const double axle = 0.57 * driver.look.length;
    const Path::Place ahead = lane.path.At(driver.along + axle, lane.right_m);
    const Path::Place behind = lane.path.At(driver.along - axle, lane.right_m);
    return {lane.path.At(driver.along, lane.right_m).position,
            (ahead.position - behind.position).normalized(), lane.HeightAt(driver.along),
            (lane.HeightAt(driver.along + axle) - lane.HeightAt(driver.along - axle)) / (2 * axle)};
  }

  double Limit(const Driver& driver) const {
    const std::vector<double>& limits = limits_[driver.lane];
    const double step =
        std::clamp(driver.along / kLimitStep, 0.0, static_cast<double>(limits.size() - 1));
    return std::min(driver.wanted, limits[static_cast<std::size_t>(step)]);
  }

  static double Follow(const Driver& driver, double wanted, double gap, double closing) {
    const double ratio = driver.speed / wanted;
    const double free = std::max(1 - ratio * ratio * ratio * ratio, -kBraking / kAcceleration);
    const double brake = driver.speed * closing / (2 * std::sqrt(kAcceleration * kBraking));
    const double desired = kStandingGap + std::max(0.0, driver.speed * kHeadway + brake);
    const double near = desired / std::max(gap, 0.1);
    return std::max(kAcceleration * (free - near * near), -kHardBraking);
  }

  double Push(const Driver& driver, double time_s) const {
    const double wanted = Limit(driver);
    double push = Follow(driver, wanted, GapToStop(driver, time_s), driver.speed);
    const double reach = 10 + 3 * driver.speed;
    for (const Driver& other : drivers_) {
      if (&other == &driver) continue;
      if ((other.pose.position - driver.pose.position).squaredNorm() > reach * reach) continue;
      if (std::abs(other.pose.height - driver.pose.height) > kHeadroom) continue;
      const double same = other.pose.forward.dot(driver.pose.forward);
      const bool crosses = same < 0.5;
      if (same < -0.7 || (crosses && other.lane > driver.lane)) continue;
      const double gap = GapTo(driver, other, reach);
      if (gap == kInfinity) continue;
      push = std::min(push, Follow(driver, wanted, gap, driver.speed - same * other.speed));
    }
    return push;
  }

  // To the next red light or place to halt at which the driver can still stop, m.
  double GapToStop(const Driver& driver, double time_s) const {
    const Lane& lane = lanes_[driver.lane];
    const double stopping = driver.speed * driver.speed / (2 * kHardBraking * 0.6);
    double gap = kInfinity;
    for (const Lane::Light& light : lane.lights) {
      const double ahead = light.at_m - driver.front();
      if (ahead > stopping && ahead < gap && IsRed(light, time_s)) gap = ahead;
    }
    if (!driver.halts.empty()) {
      const double ahead = lane.stops[driver.halts.back()].at_m - driver.front();
      if (ahead > -1) gap = std::min(gap, ahead + kStandingGap);
    }
    return gap;
  }

  // Along the driver's way to the nearest part of the other that is in it, m.
  double GapTo(const Driver& driver, const Driver& other, double reach) const {
    constexpr double kStride = 2.0;
    const Lane& lane = lanes_[driver.lane];
    const Eigen::Vector2d half = 0.5 * other.look.length * other.pose.forward;
    const double side = 0.5 * (driver.look.width + other.look.width) + kSideGap;
    double nearest = kInfinity;
    for (double ahead = 0.5 * driver.look.length; ahead < reach && nearest == kInfinity;
         ahead += kStride) {
      const Path::Place place = lane.path.At(driver.along + ahead, lane.right_m);
      for (const double share : {-1.0, 0.0, 1.0}) {
        const Eigen::Vector2d to = other.pose.position + share * half - place.position;
        const double on = to.dot(place.forward);
        if (on < -0.5 * kStride || on >= 0.5 * kStride) continue;
        if (std::abs(to.dot(Right(place.forward))) > side) continue;
        const double gap = ahead + on - 0.5 * driver.look.length;
        if (gap >= 0) nearest = std::min(nearest, gap);
      }
    }
    return nearest;
  }

  void Halt(Driver& driver, double frame_s) const {
    if (driver.halts.empty()) return;
    const Lane::Stop& stop = lanes_[driver.lane].stops[driver.halts.back()];
    const double ahead = stop.at_m - driver.front();
    if (ahead < 2 && driver.speed < 0.4) {
      driver.speed = 0;
      driver.halting_s += frame_s;
    }
    if (ahead > -2 && driver.halting_s < stop.seconds) return;
    driver.halts.pop_back();
    driver.halting_s = 0;
  }

  const std::vector<Lane>& lanes_;
  std::vector<std::vector<double>> limits_;
  std::vector<Driver> drivers_;
};

}  // namespace

std::vector<Trajectory> DriveLanes(const std::vector<Lane>& lanes, double density,
                                   std::uint64_t seed, const TrafficClock& clock) {
  Roads roads(lanes, density, seed, clock.settle * clock.frame_s);
  std::vector<Trajectory> trajectories;
  for (const Driver& driver : roads.drivers()) trajectories.push_back({0, driver.look, {}});
  for (int step = -clock.settle; step < clock.steps; ++step) {
    for (std::size_t i = 0; step >= 0 && i < trajectories.size(); ++i) {
      trajectories[i].poses.push_back(roads.drivers()[i].pose);
    }
    roads.Step((step - clock.zero) * clock.frame_s, clock.frame_s);
  }
  return trajectories;
}

}  // namespace windhover::replay
