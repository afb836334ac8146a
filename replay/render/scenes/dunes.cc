// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "replay/render/portable_math.h"
#include "replay/render/scene.h"
#include "replay/render/scenes/settlement.h"

namespace windhover::replay {
namespace {

using Eigen::Vector2d;

// The map, in metres: sand on one side, planted forest in rows on the other, and a sandy track that
// winds along x between and through both.
constexpr double kReach = 330;  // to either side of the flight
constexpr double kTreePitch = 5.6;
constexpr double kForestY = 55;  // where it begins, on average

class Dunes {
 public:
  explicit Dunes(const FlightPlan& plan)
      : pieces_(plan.seed, scene_),
        random_(Mix(plan.seed, 0xD0E5)),
        west_(plan.camera.start_x_m - 350),
        east_(plan.camera.start_x_m + plan.camera.speed_m * plan.frames + 450) {
    scene_.seed = plan.seed;
    scene_.sun.direction = Eigen::Vector3d(0.55, -0.45, 0.72).normalized();
    scene_.sun.ambient = 0.5F;
    scene_.meadow = {136, 168, 184};
    scene_.relief = {.height_m = 5.5, .length_m = 62, .ripple_m = 0.25};
  }

  Scene Build() {
    BuildTracks();
    BuildForest();
    BuildGrass();
    return std::move(scene_);
  }

 private:
  static double TrackY(double x) { return 26 * Sine(x / 190) + 7 * Sine(x / 61 + 1); }
  static double EdgeY(double x) { return kForestY + 45 * Sine(x / 260 + 2) + 14 * Sine(x / 77); }

  void BuildTracks() {
    const Path track = LineAlongX(west_ - 400, east_ + 400, TrackY);
    AddTrack(track, 6.0);
    scene_.lanes.push_back({track, 1.5, 260, 9, 15, {}, {}, {}});
    scene_.lanes.push_back({track.Reversed(), 1.5, 420, 8, 13, {}, {}, {}});
    for (double x = west_ + 100; x < east_; x += random_.Uniform(240, 420)) {
      AddTrack(RoundedPath({{x, TrackY(x)}, {x + 30, TrackY(x) + 90}, {x + 10, kReach}}, 40), 3.6);
    }
  }

  void AddTrack(const Path& path, double width) {
    for (std::size_t i = 1; i < path.points().size(); ++i) {
      const Vector2d a = path.points()[i - 1];
      const Vector2d b = path.points()[i];
      scene_.plots.push_back({{0.5 * (a + b), (b - a).normalized(), (b - a).norm() + 0.6, width},
                              GroundKind::kGravel,
                              {128, 156, 172}});
    }
  }

  // Planted in rows, all of an age: the same wherever one looks.
  void BuildForest() {
    for (double x = west_; x < east_; x += kTreePitch) {
      for (double y = EdgeY(x); y < kReach; y += kTreePitch) {
        if (std::abs(y - TrackY(x)) < 7 || random_.Chance(0.02)) continue;
        const bool ride = std::fmod(x - west_, 148) < 7;  // an open line through the rows
        if (ride) continue;
        const auto tone = static_cast<float>(random_.Uniform(0.94, 1.05));
        pieces_.AddTree({x + random_.Uniform(-0.5, 0.5), y + random_.Uniform(-0.5, 0.5)},
                        random_.Uniform(2.5, 2.9), {46 * tone, 74 * tone, 58 * tone});
      }
    }
  }

  // Tufts and bushes, the denser the nearer to the forest.
  void BuildGrass() {
    for (int i = static_cast<int>((east_ - west_) * 1.6); i > 0; --i) {
      const double x = random_.Uniform(west_, east_);
      const double share = random_.Uniform();
      const double y = EdgeY(x) - 4 - 320 * share * share;
      if (std::abs(y - TrackY(x)) < 5) continue;
      pieces_.AddTree({x, y}, random_.Uniform(0.4, 1.1), {100, 138, 146});
    }
  }

  Scene scene_;
  Settlement pieces_;
  Random random_;
  double west_;
  double east_;
};

}  // namespace

Scene BuildDunes(const FlightPlan& plan) { return Dunes(plan).Build(); }

}  // namespace windhover::replay
