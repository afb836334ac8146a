// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/object_classes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>

namespace windhover::replay {
namespace {

template <std::size_t kBounds>
std::vector<ClassRecall> MakeClasses(const std::array<double, kBounds>& bounds) {
  std::vector<ClassRecall> classes(kBounds + 1);
  for (std::size_t i = 0; i < kBounds; ++i) {
    classes[i].below = bounds[i];
    classes[i + 1].least = bounds[i];
  }
  return classes;
}

void Count(std::vector<ClassRecall>& classes, double value, bool hit) {
  const auto fits = std::find_if(classes.begin(), classes.end(), [value](const ClassRecall& one) {
    return !one.below || value < *one.below;
  });
  ++fits->truth;
  if (hit) ++fits->hits;
}

// Where one object is at one time.
struct Sighting {
  int frame;
  Eigen::Vector2d middle;
};

Eigen::Vector2d Middle(const Box& box) {
  // The left edge of pixel 0 lies at 0 in a box, its middle in a homography.
  return {box.x + (box.width - 1) / 2, box.y + (box.height - 1) / 2};
}

// By identity, by frame.
std::map<std::int64_t, std::vector<Sighting>> Sightings(std::span<const FrameBoxes> frames) {
  std::map<std::int64_t, std::vector<Sighting>> objects;
  for (const FrameBoxes& frame : frames) {
    for (const LabelledBox& box : frame.truth) {
      if (box.id >= 0) objects[box.id].push_back({frame.number, Middle(box.box)});
    }
  }
  return objects;
}

std::optional<double> Speed(const std::vector<Sighting>& sightings, int frame,
                            std::span<const Eigen::Matrix3d> first_from_frame) {
  const auto first = std::lower_bound(
      sightings.begin(), sightings.end(), frame - kSpeedFrames,
      [](const Sighting& sighting, int number) { return sighting.frame < number; });
  const auto end = std::upper_bound(
      first, sightings.end(), frame + kSpeedFrames,
      [](int number, const Sighting& sighting) { return number < sighting.frame; });
  const auto last = std::prev(end);
  if (last->frame == first->frame) return std::nullopt;
  const auto here = [&](const Sighting& sighting) -> Eigen::Vector2d {
    if (first_from_frame.empty()) return sighting.middle;
    return (first_from_frame[frame - 1].inverse() * first_from_frame[sighting.frame - 1] *
            sighting.middle.homogeneous())
        .hnormalized();
  };
  return (here(*last) - here(*first)).norm() / (last->frame - first->frame);
}

}  // namespace

std::optional<double> ClassRecall::recall() const {
  if (truth == 0) return std::nullopt;
  return static_cast<double>(hits) / truth;
}

void AddClasses(std::vector<ClassRecall>& sum, std::span<const ClassRecall> other) {
  if (sum.empty())
    sum.assign(other.begin(), other.end());
  else {
    for (std::size_t i = 0; i < other.size(); ++i) {
      sum[i].truth += other[i].truth;
      sum[i].hits += other[i].hits;
    }
  }
}

std::vector<ClassRecall> RecallBySize(std::span<const FrameBoxes> frames,
                                      std::span<const FrameMatch> matches) {
  std::vector<ClassRecall> classes = MakeClasses(kSizeBoundsPx);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t t = 0; t < frames[i].truth.size(); ++t) {
      const int partner = matches[i].detection_of_truth[t];
      if (partner == FrameMatch::kIgnored) continue;
      const Box& box = frames[i].truth[t].box;
      Count(classes, std::sqrt(box.width * box.height), partner >= 0);
    }
  }
  return classes;
}

std::vector<std::vector<std::optional<double>>> GroundSpeeds(
    std::span<const FrameBoxes> frames, std::span<const Eigen::Matrix3d> first_from_frame) {
  const auto objects = Sightings(frames);
  std::vector<std::vector<std::optional<double>>> speeds;
  for (const FrameBoxes& frame : frames) {
    if (!first_from_frame.empty() &&
        static_cast<std::size_t>(frame.number) > first_from_frame.size()) {
      throw std::invalid_argument("there is no homography of frame " +
                                  std::to_string(frame.number));
    }
  }
  for (const FrameBoxes& frame : frames) {
    std::vector<std::optional<double>>& of_frame = speeds.emplace_back();
    for (const LabelledBox& box : frame.truth) {
      of_frame.push_back(box.id < 0 ? std::nullopt
                                    : Speed(objects.at(box.id), frame.number, first_from_frame));
    }
  }
  return speeds;
}

std::vector<ClassRecall> RecallBySpeed(std::span<const FrameBoxes> frames,
                                       std::span<const FrameMatch> matches,
                                       std::span<const Eigen::Matrix3d> first_from_frame) {
  std::vector<ClassRecall> classes = MakeClasses(kSpeedBoundsPx);
  const auto speeds = GroundSpeeds(frames, first_from_frame);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t t = 0; t < frames[i].truth.size(); ++t) {
      const int partner = matches[i].detection_of_truth[t];
      if (partner != FrameMatch::kIgnored && speeds[i][t]) {
        Count(classes, *speeds[i][t], partner >= 0);
      }
    }
  }
  return classes;
}

}  // namespace windhover::replay
