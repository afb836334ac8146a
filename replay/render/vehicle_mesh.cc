// SPDX-License-Identifier: Apache-2.0
#include "replay/render/vehicle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "replay/render/portable_math.h"

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
    const Eigen::Vector3d inside = At(0.5 * (taper.front_low + taper.rear_low), 0,
                                      std::min(0.5 * (taper.low + taper.high), 0.5));
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      Add({low[i], low[j], high[j], high[i]}, inside, sides);
    }
    Add(high, inside, top);
  }

  // A limb from joint to joint, (along, right, up) in m from the middle of the feet.
  void AddLimb(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double thick,
               const Colour& colour) {
    std::array<Eigen::Vector3d, 4> low{};
    std::array<Eigen::Vector3d, 4> high{};
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d corner(i < 2 ? thick : -thick, i == 1 || i == 2 ? thick : -thick, 0);
      low[i] = InWorld(from + corner);
      high[i] = InWorld(to + corner);
    }
    const Eigen::Vector3d inside = InWorld(0.5 * (from + to));
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      Add({low[i], low[j], high[j], high[i]}, inside, colour);
    }
    Add(high, inside, colour);
  }

 private:
  Eigen::Vector3d At(double along, double right, double height) const {
    const Eigen::Vector2d spot = pose_.position + 0.5 * look_.length * along * pose_.forward +
                                 0.5 * look_.width * right * Right(pose_.forward);
    return {spot.x(), spot.y(), pose_.height + height + 0.5 * look_.length * along * pose_.pitch};
  }
  Eigen::Vector3d InWorld(const Eigen::Vector3d& own) const {
    return At(2 * own.x() / look_.length, 2 * own.y() / look_.width, own.z());
  }

  void Add(const std::array<Eigen::Vector3d, 4>& corners, const Eigen::Vector3d& inside,
           const Colour& colour) {
    Eigen::Vector3d normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized();
    const Eigen::Vector3d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    if (normal.dot(middle - inside) < 0) normal = -normal;
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

// Legs and arms swing against each other, a pair of steps every 1.4 m.
void AddPerson(const VehicleLook& look, const VehiclePose& pose, Skin& skin) {
  constexpr Colour kSkin = {120, 150, 190};
  constexpr Colour kHair = {38, 48, 62};
  const double size = look.height / 1.75;
  const double swing = 0.26 * Sine(2 * kPi * pose.phase / 1.4);
  for (const double side : {-1.0, 1.0}) {
    skin.AddLimb({side * swing * size, 0.10 * side, 0.03}, {0, 0.10 * side, 0.86 * size}, 0.085,
                 look.glass);
    skin.AddLimb({-0.8 * side * swing * size, 0.27 * side, 0.8 * size},
                 {0, 0.24 * side, 1.38 * size}, 0.06, look.paint);
  }
  skin.AddLimb({0, -0.08, 0.84 * size}, {0, -0.08, 1.45 * size}, 0.13, look.paint);
  skin.AddLimb({0, 0.08, 0.84 * size}, {0, 0.08, 1.45 * size}, 0.13, look.paint);
  skin.AddLimb({0.02, 0, 1.45 * size}, {0.02, 0, 1.64 * size}, 0.09, kSkin);
  skin.AddLimb({-0.01, 0, 1.62 * size}, {-0.01, 0, look.height}, 0.10, kHair);
}

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
      AddPerson(look, pose, skin);
      break;
  }
}

std::vector<Eigen::Vector2d> ShadowOutline(const VehicleLook& look, const VehiclePose& pose,
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

void AppendFaces(const Flag& flag, double foot_m, const Wind& wind, const Sun& sun, double time_s,
                 std::vector<Face>& faces) {
  constexpr int kColumns = 6;
  const auto rows = static_cast<int>(flag.bands.size());
  Random random(flag.seed);
  const double late = random.Uniform(0, 10);
  // The wind turns a little; waves run out along the cloth and grow, its end hangs lower.
  const double turn = 0.35 * Sine(0.9 * time_s + late) + 0.15 * Sine(2.3 * time_s + 2 * late);
  const Eigen::Vector2d along = (wind.direction + turn * Right(wind.direction)).normalized();
  const auto point = [&](int column, int row) -> Eigen::Vector3d {
    const double out = static_cast<double>(column) / kColumns;
    const double wave = 0.16 * out * Sine(7.0 * out - 9.5 * time_s + late);
    const Eigen::Vector2d spot =
        flag.foot + flag.length * (0.96 * out * along + wave * Right(along));
    const double sag = 0.12 * flag.length * out * (1 + 0.4 * Sine(3.1 * time_s + late));
    return {spot.x(), spot.y(), foot_m + flag.height - sag - flag.drop * row / rows};
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const std::array<Eigen::Vector3d, 4> corners = {point(column, row), point(column + 1, row),
                                                      point(column + 1, row + 1),
                                                      point(column, row + 1)};
      const Eigen::Vector3d normal =
          (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized();
      // Sun shines through the cloth.
      const auto facing = static_cast<float>(std::abs(normal.dot(sun.direction)));
      const float light = sun.ambient + 0.1F + 0.8F * (1 - sun.ambient) * facing;
      const Colour& band = flag.bands[row];
      faces.push_back({corners, {band[0] * light, band[1] * light, band[2] * light}});
    }
  }
}

}  // namespace windhover::replay
