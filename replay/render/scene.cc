// SPDX-License-Identifier: Apache-2.0
#include "replay/render/scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "replay/render/portable_math.h"

namespace windhover::replay {
namespace {

Colour RandomPaint(Random& random) {
  struct Choice {
    double share;
    Colour colour;
  };
  // Shares as on the roads of Europe; "asphalt" is the hard one.
  static constexpr std::array<Choice, 9> kChoices = {{{0.20, {226, 226, 224}},  // white
                                                      {0.15, {172, 172, 170}},  // silver
                                                      {0.20, {106, 104, 103}},  // asphalt grey
                                                      {0.15, {38, 36, 36}},     // black
                                                      {0.08, {62, 58, 54}},     // anthracite
                                                      {0.08, {52, 48, 150}},    // red
                                                      {0.08, {128, 82, 48}},    // blue
                                                      {0.03, {70, 190, 214}},   // yellow
                                                      {0.03, {70, 92, 60}}}};   // green
  double pick = random.Uniform();
  Colour colour = kChoices.back().colour;
  for (const Choice& choice : kChoices) {
    colour = choice.colour;
    pick -= choice.share;
    if (pick < 0) break;
  }
  const auto shift = static_cast<float>(random.Uniform(-8, 8));
  for (float& channel : colour) channel += shift;
  return colour;
}

}  // namespace

VehicleLook RandomVehicle(Random& random) {
  VehicleLook look;
  look.paint = RandomPaint(random);
  const double kind = random.Uniform();
  if (kind < 0.84) {
    const double size = random.Uniform(0.92, 1.08);
    return {VehicleKind::kCar, look.paint, 4.4 * size, 1.85 * (0.5 + 0.5 * size),
            random.Uniform(1.4, 1.6)};
  }
  if (kind < 0.96) return {VehicleKind::kVan, look.paint, random.Uniform(4.9, 5.9), 2.05, 2.2};
  return {VehicleKind::kTruck, look.paint, random.Uniform(7.5, 9.5), 2.45, 3.1};
}

VehicleLook RandomPerson(Random& random) {
  static constexpr std::array<Colour, 8> kClothes = {{{210, 208, 204},
                                                      {48, 44, 44},
                                                      {108, 106, 104},
                                                      {120, 86, 58},
                                                      {64, 58, 146},
                                                      {98, 104, 110},
                                                      {70, 96, 70},
                                                      {150, 168, 178}}};
  Colour colour = kClothes[random.Below(kClothes.size())];
  const auto shift = static_cast<float>(random.Uniform(-10, 10));
  for (float& channel : colour) channel += shift;
  return {VehicleKind::kPerson, colour, random.Uniform(0.4, 0.6), random.Uniform(0.48, 0.6),
          random.Uniform(1.6, 1.9)};
}

VehicleLook WithContrast(VehicleLook look, double contrast) {
  constexpr float kAsphalt = 105;
  for (float& channel : look.paint) {
    channel =
        std::clamp(kAsphalt + static_cast<float>(contrast) * (channel - kAsphalt), 8.0F, 247.0F);
  }
  return look;
}

VehicleLook ThermalLook(VehicleLook look, double warm, Random& random) {
  double level = random.Uniform(88, 110);
  double glass = level - 8;
  if (random.Chance(warm)) {
    const bool mirrors = random.Chance(0.3);
    level = mirrors ? random.Uniform(48, 66) : random.Uniform(136, 180);
    glass = mirrors ? level + 45 : level - 22;
  }
  look.paint.fill(static_cast<float>(level));
  look.glass.fill(static_cast<float>(glass));
  return look;
}

double Scene::Highest() const {
  double most = 0;
  const auto stands = [&most](double height) { most = std::max(most, height); };
  for (const Building& building : buildings) stands(building.eaves + building.rise + 2);
  for (const Tree& tree : trees) stands(1.15 * tree.height);
  for (const Hedge& hedge : hedges) stands(1.1 * hedge.height);
  for (const Pole& pole : poles) stands(pole.height);
  for (const Wall& wall : walls) stands(wall.height);
  for (const Canopy& canopy : canopies) stands(canopy.height + 0.5);
  for (const Flag& flag : flags) stands(flag.height + 0.3);
  for (const Bridge& bridge : bridges) {
    for (const HeightKnot& knot : bridge.knots) stands(knot.height_m + 1);
  }
  return most + 1.2 * relief.height_m + 2 * relief.ripple_m;
}

// Dunes rise slowly on the side the wind comes from and fall fast behind the crest.
float Scene::GroundAt(float x, float y) const {
  if (relief.height_m <= 0) return 0;
  constexpr float kRise = 0.72F;  // share of the way from trough to trough
  const auto key = static_cast<std::uint32_t>(seed) * 53U;
  const auto length = static_cast<float>(relief.length_m);
  const auto edge = static_cast<float>(relief.edge_y_m);
  const float flat = std::clamp((edge - y) / 40, 0.0F, 1.0F);
  const auto smooth = [](float share) { return share * share * (3 - 2 * share); };
  const Eigen::Vector2f across = wind.direction.cast<float>();
  const float way = (x * across.x() + y * across.y()) / length +
                    0.9F * Noise(x / (1.9F * length), y / (1.9F * length), key) +
                    0.25F * Noise(x / (0.6F * length), y / (0.6F * length), key + 1);
  const float phase = way - std::floor(way);
  const float share = phase < kRise ? phase / kRise : (1 - phase) / (1 - kRise);
  const float size = 0.65F + 0.35F * Noise(x / (2.7F * length), y / (2.7F * length), key + 2);
  const float ripple_length = 0.075F * length;
  const float ripple =
      Noise((x * across.x() + y * across.y()) / (0.3F * ripple_length) +
                1.3F * Noise(x / (4 * ripple_length), y / (4 * ripple_length), key + 3),
            (y * across.x() - x * across.y()) / (3 * ripple_length), key + 4);
  return smooth(flat) * (static_cast<float>(relief.height_m) * size * smooth(share) +
                         static_cast<float>(relief.ripple_m) * (1 + ripple));
}

namespace {

Scene BuildByKind(const FlightPlan& plan) {
  switch (plan.scene) {
    case SceneKind::kOutskirts:
      return BuildOutskirts(plan);
    case SceneKind::kTowers:
      return BuildTowers(plan);
    case SceneKind::kStreets:
      return BuildStreets(plan);
    case SceneKind::kSquare:
      return BuildSquare(plan);
    case SceneKind::kInterchange:
      return BuildInterchange(plan);
    case SceneKind::kCountry:
      return BuildCountry(plan);
    case SceneKind::kDunes:
      return BuildDunes(plan);
    case SceneKind::kValley:
      return BuildValley(plan);
    case SceneKind::kHarbour:
      return BuildHarbour(plan);
    case SceneKind::kHighway:
      return BuildHighway(plan);
    case SceneKind::kSuburb:
      return BuildSuburb(plan);
    default:
      throw std::invalid_argument("no builder for the scene of " + plan.name);
  }
}

}  // namespace

Scene BuildScene(const FlightPlan& plan) {
  Scene scene = BuildByKind(plan);
  scene.traffic_contrast = plan.traffic_contrast;
  for (ParkedVehicle& parked : scene.parked) {
    parked.look = WithContrast(parked.look, plan.traffic_contrast);
  }
  return scene;
}

}  // namespace windhover::replay
