// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <thread>
#include <vector>

#include "replay/render/portable_math.h"
#include "replay/render/renderer.h"

// Holds the embedded flight to its difficulty, so that no later change makes it easy unseen. The
// bounds leave room for another seed, not for another kind of flight.

namespace windhover::replay {
namespace {

class FlightDifficulty : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    flight_ = new Renderer(FindFlightPlan("flight"),
                           static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  }
  static void TearDownTestSuite() {
    delete flight_;
    flight_ = nullptr;
  }
  static const Renderer& flight() { return *flight_; }
  // Frames all over the flight, none within ten frames of its end.
  static std::vector<int> Frames(int step) {
    std::vector<int> frames;
    for (int frame = 5; frame + 10 < flight().plan().frames; frame += step) frames.push_back(frame);
    return frames;
  }

 private:
  inline static Renderer* flight_ = nullptr;
};

TEST_F(FlightDifficulty, ParallaxIsReal) {
  double sum = 0;
  const std::vector<int> frames = Frames(35);
  for (const int frame : frames) sum += flight().OffPlaneShare(frame, 10, 1.0);
  const double share = sum / static_cast<double>(frames.size());
  RecordProperty("off_plane_percent", static_cast<int>(std::lround(100 * share)));
  EXPECT_GE(share, 0.06);
  EXPECT_LE(share, 0.20);
}

TEST_F(FlightDifficulty, TheCameraMovesTurnsAndClimbs) {
  const Eigen::Vector2d centre(319.5, 239.5);
  std::vector<double> shifts;
  std::vector<double> turns;
  double least_scale = 10;
  double most_scale = 0;
  for (int frame = 1; frame < flight().plan().frames; ++frame) {
    const Eigen::Matrix3d previous_from_frame =
        flight().TrueHomography(frame - 1).inverse() * flight().TrueHomography(frame);
    const auto at = [&](const Eigen::Vector2d& point) {
      return Eigen::Vector2d((previous_from_frame * point.homogeneous()).hnormalized());
    };
    shifts.push_back((at(centre) - centre).norm());
    const Eigen::Vector2d across = at(centre + Eigen::Vector2d(100, 0)) - at(centre);
    turns.push_back(std::abs(std::atan2(across.y(), across.x())) * 180 / kPi);
    const Eigen::Matrix3d& whole = flight().TrueHomography(frame);
    const double scale = ((whole * (centre + Eigen::Vector2d(100, 0)).homogeneous()).hnormalized() -
                          (whole * centre.homogeneous()).hnormalized())
                             .norm() /
                         100;
    least_scale = std::min(least_scale, scale);
    most_scale = std::max(most_scale, scale);
  }
  std::sort(shifts.begin(), shifts.end());
  std::sort(turns.begin(), turns.end());
  EXPECT_GE(shifts[shifts.size() / 2], 3.5) << "px a frame";
  EXPECT_GE(turns[turns.size() / 2], 0.25) << "degrees a frame";
  EXPECT_GE(most_scale / least_scale, 1.02) << "change of height";
}

TEST_F(FlightDifficulty, MoversAreSmallManyAndAmongDecoys) {
  double movers = 0;
  double decoys = 0;
  std::vector<double> lengths;
  const std::vector<int> frames = Frames(15);
  for (const int frame : frames) {
    const FrameTruth truth = flight().Truth(frame);
    movers += static_cast<double>(truth.movers.size());
    decoys += static_cast<double>(truth.decoys.size());
    for (const LabelledBox& box : truth.movers) {
      lengths.push_back(std::max(box.box.width, box.box.height));
    }
  }
  movers /= static_cast<double>(frames.size());
  decoys /= static_cast<double>(frames.size());
  EXPECT_GE(movers, 10);
  EXPECT_LE(movers, 25);
  EXPECT_GE(decoys, 20);
  std::sort(lengths.begin(), lengths.end());
  EXPECT_LE(lengths[lengths.size() / 2], 24) << "px, the longer side";
}

TEST_F(FlightDifficulty, SomeMoversHardlyDifferFromTheRoad) {
  int faint = 0;
  int all = 0;
  for (const int frame : Frames(35)) {
    cv::Mat luma;
    cv::cvtColor(flight().Frame(frame), luma, cv::COLOR_BGR2GRAY);
    for (const LabelledBox& box : flight().Truth(frame).movers) {
      const cv::Rect inside(static_cast<int>(box.box.x), static_cast<int>(box.box.y),
                            static_cast<int>(box.box.width), static_cast<int>(box.box.height));
      const cv::Rect around =
          cv::Rect(inside.x - 5, inside.y - 5, inside.width + 10, inside.height + 10) &
          cv::Rect(0, 0, luma.cols, luma.rows);
      const double outer = cv::sum(luma(around))[0] - cv::sum(luma(inside))[0];
      const double contrast = cv::mean(luma(inside))[0] - outer / (around.area() - inside.area());
      ++all;
      if (std::abs(contrast) < 12) ++faint;
    }
  }
  RecordProperty("faint_percent", 100 * faint / all);
  EXPECT_GE(faint, all / 10);
}

TEST_F(FlightDifficulty, SomeVehiclesStop) {
  // A vehicle that is a mover at one time and a decoy at another has stopped or started in sight.
  std::map<std::int64_t, int> roles;
  for (const int frame : Frames(8)) {
    const FrameTruth truth = flight().Truth(frame);
    for (const LabelledBox& box : truth.movers) roles[box.id] |= 1;
    for (const LabelledBox& box : truth.decoys) roles[box.id] |= 2;
  }
  const auto both =
      std::count_if(roles.begin(), roles.end(), [](const auto& role) { return role.second == 3; });
  EXPECT_GE(both, 2);
}

}  // namespace
}  // namespace windhover::replay
