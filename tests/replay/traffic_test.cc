// SPDX-License-Identifier: Apache-2.0
#include "replay/render/traffic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "replay/render/flight_plan.h"
#include "replay/render/path.h"
#include "replay/render/scene.h"

// What moves below: vehicles and people on their ways.

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

TEST(RoundedPath, CutsCornersAndKeepsItsEnds) {
  const Path path = RoundedPath({{0, 0}, {100, 0}, {100, 50}}, 15);
  EXPECT_EQ(path.At(0).position, Vector2d(0, 0));
  EXPECT_LT((path.At(path.length()).position - Vector2d(100, 50)).norm(), 1e-9);
  EXPECT_LT(path.length(), 150);
  double sharpest = 1;
  for (double at = 0; at < path.length(); at += 1) {
    sharpest = std::min(sharpest, path.At(at).forward.dot(path.At(at + 1).forward));
  }
  EXPECT_GT(sharpest, std::cos(0.25)) << "no turn of more than that in a metre";
}

// Two roads that cross, one lane that turns from one into the other, a stop, and a light.
Scene CrossRoads() {
  Scene scene;
  scene.seed = 5;
  scene.lanes.push_back({Path({{-300, 0}, {300, 0}}), 1.8, 45, 10, 15, {{285, 14, 0, 8}}, {}, {}});
  scene.lanes.push_back(
      {RoundedPath({{-300, 0}, {0, 0}, {0, 200}}, 14), 1.8, 90, 9, 13, {}, {{400, 3, 1}}, {}});
  scene.lanes.push_back({Path({{0, -200}, {0, 300}}), 1.8, 140, 8, 11, {}, {}, {}});
  return scene;
}

TEST(Traffic, MoreFramesChangeNothingBefore) {
  const Traffic shorter(CrossRoads(), 1, 50, 25);
  const Traffic longer(CrossRoads(), 1, 120, 25);
  ASSERT_EQ(shorter.vehicles().size(), longer.vehicles().size());
  for (std::size_t i = 0; i < shorter.vehicles().size(); ++i) {
    for (const double time : {-7.5, 0.0, 49.25}) {
      EXPECT_EQ(shorter.PoseAt(shorter.vehicles()[i], time).position,
                longer.PoseAt(longer.vehicles()[i], time).position);
    }
  }
}

TEST(Traffic, VehiclesSlowDownInBendsAndHaltWhereTheyShould) {
  constexpr int kFrames = 500;
  const Traffic traffic(CrossRoads(), 1, kFrames, 25);
  double fastest_in_bend = 0;
  double fastest = 0;
  int halted = 0;
  for (const Traffic::Vehicle& vehicle : traffic.vehicles()) {
    for (int frame = 0; frame < kFrames; ++frame) {
      const VehiclePose pose = traffic.PoseAt(vehicle, frame);
      const double speed =
          25 * (traffic.PoseAt(vehicle, frame + 1).position - pose.position).norm();
      fastest = std::max(fastest, speed);
      // Half-way round the corner.
      const double across = std::abs(pose.forward.x() * pose.forward.y());
      if (across > 0.4 && pose.position.norm() < 20) {
        fastest_in_bend = std::max(fastest_in_bend, speed);
      }
      const bool at_stop = pose.position.y() > 90 && pose.position.y() < 112;
      if (at_stop && std::abs(pose.position.x() + 1.8) < 0.1 && speed < 0.1) ++halted;
    }
  }
  EXPECT_GT(fastest, 11) << "m/s";
  EXPECT_GT(fastest_in_bend, 1);
  EXPECT_LT(fastest_in_bend, 8);
  EXPECT_GT(halted, 25) << "frames that somebody stands at the stop";
}

TEST(Traffic, VehiclesOfDifferentLanesKeepApart) {
  constexpr int kFrames = 400;
  const Traffic traffic(CrossRoads(), 1, kFrames, 25);
  int overlaps = 0;
  int pairs = 0;
  const auto& all = traffic.vehicles();
  for (int frame = 0; frame < kFrames; frame += 4) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Vector2d apart =
            traffic.PoseAt(all[i], frame).position - traffic.PoseAt(all[k], frame).position;
        if (apart.norm() < 30) ++pairs;
        if (apart.norm() < 1.8) ++overlaps;
      }
    }
  }
  EXPECT_GT(pairs, 200);
  EXPECT_LE(overlaps, pairs / 200);
}

TEST(Traffic, DensityIsANumberOfVehicles) {
  const auto count = [](double density) {
    return static_cast<double>(Traffic(CrossRoads(), density, 20, 25).vehicles().size());
  };
  EXPECT_NEAR(count(0.5) / count(1), 0.5, 0.12);
}

TEST(Traffic, ContrastIsTheDistanceOfColoursFromAsphalt) {
  FlightPlan plan = FindFlightPlan("flight");
  const auto looks = [&plan](double contrast) {
    plan.traffic_contrast = contrast;
    const Scene scene = BuildScene(plan);
    std::vector<VehicleLook> all;
    for (const ParkedVehicle& parked : scene.parked) all.push_back(parked.look);
    const Traffic traffic(scene, 1, 10, 25);
    for (const Traffic::Vehicle& vehicle : traffic.vehicles()) all.push_back(vehicle.look);
    return all;
  };
  const std::vector<VehicleLook> plain = looks(1);
  const std::vector<VehicleLook> weak = looks(0.5);
  const std::vector<VehicleLook> strong = looks(3);
  ASSERT_GT(plain.size(), 50U);
  ASSERT_EQ(plain.size(), weak.size());
  ASSERT_EQ(plain.size(), strong.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(2 * (weak[i].paint[channel] - 105), plain[i].paint[channel] - 105, 1e-3);
      EXPECT_NEAR(strong[i].paint[channel],
                  std::clamp(105 + 3 * (plain[i].paint[channel] - 105), 8.0F, 247.0F), 1e-3);
    }
  }
}

TEST(Traffic, VehiclesOnABridgeDoNotBrakeForThoseBelow) {
  Scene scene;
  scene.seed = 5;
  scene.lanes.push_back({Path({{-300, 0}, {300, 0}}), 0, 12, 0.1, 0.2, {}, {}, {}});  // a queue
  scene.lanes.push_back({Path({{0, -300}, {0, 300}}), 0, 100, 12, 13, {}, {}, {{0, 6}}});
  const Traffic traffic(scene, 1, 300, 25);
  for (const Traffic::Vehicle& vehicle : traffic.vehicles()) {
    const VehiclePose start = traffic.PoseAt(vehicle, 0);
    if (start.height == 0) continue;
    EXPECT_EQ(start.height, 6);
    EXPECT_GT((traffic.PoseAt(vehicle, 299).position - start.position).norm(), 299 * 0.04 * 9);
  }
}

TEST(Traffic, PeopleWalkStopAndTurn) {
  Scene scene;
  scene.seed = 11;
  scene.walks.push_back({Path({{0, 0}, {60, 10}}), 4, 30, 0.7, 1.5});
  constexpr int kFrames = 500;
  const Traffic traffic(scene, 1, kFrames, 25);
  ASSERT_GE(traffic.vehicles().size(), 40U);
  double fastest = 0;
  int standing = 0;
  int turned = 0;
  for (const Traffic::Vehicle& person : traffic.vehicles()) {
    EXPECT_EQ(person.look.kind, VehicleKind::kPerson);
    bool back = false;
    for (int frame = 0; frame < kFrames; ++frame) {
      const VehiclePose pose = traffic.PoseAt(person, frame);
      const double speed = 25 * (traffic.PoseAt(person, frame + 1).position - pose.position).norm();
      fastest = std::max(fastest, speed);
      if (speed < 0.1) ++standing;
      back = back || pose.forward.dot(traffic.PoseAt(person, 0).forward) < -0.9;
    }
    if (back) ++turned;
  }
  const auto people = static_cast<int>(traffic.vehicles().size());
  EXPECT_LT(fastest, 2.2) << "m/s";
  EXPECT_GT(standing, people * kFrames / 50);
  EXPECT_LT(standing, people * kFrames / 2);
  EXPECT_GT(turned, people / 5);
}

}  // namespace
}  // namespace windhover::replay
