// SPDX-License-Identifier: Apache-2.0
#include "replay/render/vehicle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace windhover::replay {
namespace {

constexpr double kClearance = 0.25;  // m under the body

// A box that tapers upwards; shares of the vehicle's half length and half width.
struct Taper {
  double low;       // m
  double high;      // m
  double rear_low;  // where it begins and ends, -1 (rear) to 1 (front)
  double front_low;
  double rear_high;
  double front_high;
  double side_low;
  double side_high;
};

class Skin {
 public:
  Skin(const VehicleLook& look, const VehiclePose& pose, const Sun& sun, float sun_share,
       std::vector<Face>& faces)
      : look_(look), pose_(pose), sun_(sun), sun_share_(sun_share), faces_(faces) {}

  void Add(const Taper& taper, const Colour& sides, const Colour& top) {
    std::array<Eigen::Vector3d, 4> low{};
    std::array<Eigen::Vector3d, 4> high{};
    for (int i = 0; i < 4; ++i) {
      const bool front = i < 2;
      const double right = i == 1 || i == 2 ? 1 : -1;
      low[i] = At(front ? taper.front_low : taper.rear_low, right * taper.side_low, taper.low);
      high[i] = At(front ? taper.front_high : taper.rear_high, right * taper.side_high, taper.high);
    }
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      Add({low[i], low[j], high[j], high[i]}, sides);
    }
    Add(high, top);
  }

 private:
  Eigen::Vector3d At(double along, double right, double height) const {
    const Eigen::Vector2d spot = pose_.position + 0.5 * look_.length * along * pose_.forward +
                                 0.5 * look_.width * right * Right(pose_.forward);
    return {spot.x(), spot.y(), height};
  }

  void Add(const std::array<Eigen::Vector3d, 4>& corners, const Colour& colour) {
    Eigen::Vector3d normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized();
    const Eigen::Vector3d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const Eigen::Vector3d out(middle.x() - pose_.position.x(), middle.y() - pose_.position.y(),
                              middle.z() - 0.5);
    if (normal.dot(out) < 0) normal = -normal;
    const auto facing =
        static_cast<float>(std::max(0.0, normal.dot(sun_.direction)) / sun_.direction.z());
    const float light = sun_.ambient + (1 - sun_.ambient) * sun_share_ * std::min(facing, 1.25F);
    faces_.push_back({corners, {colour[0] * light, colour[1] * light, colour[2] * light}});
  }

  const VehicleLook& look_;
  const VehiclePose& pose_;
  const Sun& sun_;
  float sun_share_;
  std::vector<Face>& faces_;
};

}  // namespace

void AppendFaces(const VehicleLook& look, const VehiclePose& pose, const Sun& sun, float sun_share,
                 std::vector<Face>& faces) {
  Skin skin(look, pose, sun, sun_share, faces);
  const Colour& paint = look.paint;
  const double top = look.height;
  switch (look.kind) {
    case VehicleKind::kCar:
      skin.Add({kClearance, 0.88, -1, 1, -0.97, 0.96, 1, 0.94}, paint, paint);
      skin.Add({0.88, top, -0.72, 0.36, -0.46, 0.02, 0.9, 0.72}, look.glass, paint);
      break;
    case VehicleKind::kVan:
      skin.Add({kClearance, 1.05, -1, 1, -1, 0.96, 1, 1}, paint, paint);
      skin.Add({1.05, top, -1, 0.72, -0.98, 0.42, 0.98, 0.9}, paint, paint);
      skin.Add({1.05, top - 0.25, 0.5, 0.75, 0.4, 0.5, 0.9, 0.84}, look.glass, paint);
      break;
    case VehicleKind::kTruck:
      skin.Add({0.5, 2.4, 0.62, 1, 0.66, 0.96, 0.98, 0.92}, paint, paint);
      skin.Add({0.9, top, -1, 0.55, -1, 0.55, 1, 1}, paint, Between(paint, {190, 190, 188}, 0.6F));
      break;
    case VehicleKind::kPerson:
      skin.Add({0.05, 0.85, -0.8, 0.8, -0.6, 0.6, 0.55, 0.7}, look.glass, look.glass);
      skin.Add({0.85, top - 0.25, -0.6, 0.6, -0.5, 0.5, 0.8, 1.0}, paint, paint);
      skin.Add({top - 0.25, top, -0.4, 0.4, -0.4, 0.4, 0.4, 0.35}, {64, 78, 98}, {40, 52, 70});
      break;
  }
}

std::array<Eigen::Vector2d, 6> ShadowOutline(const VehicleLook& look, const VehiclePose& pose,
                                             const Sun& sun) {
  // The roof is smaller than the body; its shadow as high as this is as long as the real one.
  const double height = 0.85 * look.height;
  const Eigen::Vector2d shift = -sun.direction.head<2>() / sun.direction.z() * height;
  const Eigen::Vector2d along = 0.5 * look.length * pose.forward;
  const Eigen::Vector2d across = 0.5 * look.width * Right(pose.forward);
  std::array<Eigen::Vector2d, 4> base = {
      pose.position + along - across, pose.position + along + across,
      pose.position - along + across, pose.position - along - across};
  // Start behind the corner that lies farthest against the shift: from there the outline follows
  // the base for three corners and the shifted base for the other three.
  int last = 0;
  for (int i = 1; i < 4; ++i) {
    if (base[i].dot(shift) < base[last].dot(shift)) last = i;
  }
  const auto corner = [&](int i) { return base[(last + i + 4) % 4]; };
  return {corner(-1),        corner(0),         corner(1),
          corner(1) + shift, corner(2) + shift, corner(3) + shift};
}

}  // namespace windhover::replay
