// SPDX-License-Identifier: Apache-2.0
#include "replay/render/walkers.h"

#include <algorithm>
#include <cmath>

#include "replay/render/portable_math.h"

namespace windhover::replay {
namespace {

struct Walker {
  VehicleLook look;
  double ahead = 0.0;  // of the group's middle, m
  double right = 0.0;  // of the walk's line, m
  double phase = 0.0;  // of the swaying gait
};

// People who go together, and what they are about to do.
class Group {
 public:
  Group(const Walk& walk, std::uint64_t key) : walk_(walk), random_(key) {
    along_ = random_.Uniform(0, walk.path.length());
    direction_ = random_.Chance(0.5) ? 1 : -1;
    const double middle = random_.Uniform(-0.5, 0.5) * walk.width_m;
    static constexpr std::array<int, 6> kSizes = {1, 1, 2, 2, 3, 4};
    for (int i = kSizes[random_.Below(kSizes.size())]; i > 0; --i) {
      const double side = static_cast<double>(walkers_.size() % 2);
      walkers_.push_back({RandomPerson(random_), random_.Uniform(-0.9, 0.9) + 0.5 * side,
                          middle + 0.9 * (side - 0.5) + random_.Uniform(-0.2, 0.2),
                          random_.Uniform()});
    }
    Decide();
    speed_ = goal_;
  }

  const std::vector<Walker>& walkers() const { return walkers_; }

  void Step(double frame_s) {
    left_s_ -= frame_s;
    const bool at_end =
        (direction_ > 0 && along_ > walk_.path.length() - 2) || (direction_ < 0 && along_ < 2);
    if (at_end) {
      turning_ = true;
    } else if (left_s_ <= 0) {
      Decide();
    }
    // One stops before one turns.
    const double goal = turning_ ? 0.0 : goal_;
    speed_ += (goal - speed_) * std::min(1.0, 2.5 * frame_s);
    if (turning_ && speed_ < 0.08) {
      turning_ = false;
      direction_ = -direction_;
    }
    along_ += direction_ * speed_ * frame_s;
    way_ += speed_ * frame_s;
    time_s_ += frame_s;
  }

  VehiclePose PoseOf(const Walker& walker) const {
    const double sway = 0.06 * std::min(1.0, speed_) * Sine(2 * kPi * (time_s_ + walker.phase));
    const Path::Place place = walk_.path.At(along_ + walker.ahead, walker.right + sway);
    return {place.position, direction_ * place.forward, 0, 0, way_ + walker.phase};
  }

 private:
  void Decide() {
    const bool stands = goal_ > 0 && random_.Chance(0.22);
    goal_ = stands ? 0.0 : random_.Uniform(walk_.speed_low, walk_.speed_high);
    left_s_ = stands ? random_.Uniform(1.5, 5) : random_.Uniform(3, 11);
    turning_ = !stands && random_.Chance(0.18);
  }

  const Walk& walk_;
  Random random_;
  std::vector<Walker> walkers_;
  double along_ = 0.0;
  double direction_ = 1.0;
  double speed_ = 0.0;
  double goal_ = 0.0;
  double left_s_ = 0.0;
  double way_ = 0.0;
  double time_s_ = 0.0;
  bool turning_ = false;
};

}  // namespace

std::vector<Trajectory> FollowWalks(const std::vector<Walk>& walks, double density,
                                    std::uint64_t seed, const TrafficClock& clock) {
  std::vector<Trajectory> trajectories;
  for (std::size_t walk = 0; walk < walks.size(); ++walk) {
    // A share of a group is the chance of one.
    const double chance = Random(Mix(seed, 0x6A0B + walk)).Uniform();
    const auto groups = static_cast<int>(std::floor(walks[walk].groups * density + chance));
    for (int i = 0; i < groups; ++i) {
      Group group(walks[walk], Mix(seed, Mix(0x3A1C + walk, static_cast<std::uint64_t>(i))));
      const std::size_t first = trajectories.size();
      for (const Walker& walker : group.walkers()) trajectories.push_back({0, walker.look, {}});
      for (int step = -clock.settle; step < clock.steps; ++step) {
        for (std::size_t k = 0; step >= 0 && k < group.walkers().size(); ++k) {
          trajectories[first + k].poses.push_back(group.PoseOf(group.walkers()[k]));
        }
        group.Step(clock.frame_s);
      }
    }
  }
  return trajectories;
}

}  // namespace windhover::replay
