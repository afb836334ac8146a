// SPDX-License-Identifier: Apache-2.0
#include "replay/render/land.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "replay/render/clip.h"
#include "replay/render/ground_photo.h"
#include "replay/render/portable_math.h"
#include "replay/render/ray_caster.h"
#include "replay/render/renderer.h"
#include "replay/render/shading.h"
#include "replay/render/terrain.h"

namespace windhover::replay {
namespace {

// A house, a tree on its trunk, a bridge, a wall and a pole on 60x40 m.
Scene SmallScene() {
  Scene scene;
  scene.seed = 3;
  scene.sun.direction = Eigen::Vector3d(-0.5, 0.4, 0.9).normalized();
  scene.meadow = {64, 104, 96};
  scene.buildings.push_back({{{12, 12}, Eigen::Vector2d(1, 0.3).normalized(), 11, 8}});
  scene.trees.push_back({{-10, 6}, 3.0, 7.0, {44, 82, 66}, 9});
  scene.walls.push_back({{{0, -8}, Eigen::Vector2d::UnitX(), 9, 0.4}, 1.7});
  scene.poles.push_back({{5, 2}});
  const Path path({{-25, -14}, {25, -14}});
  scene.bridges.push_back({path, 7, 3, {{0, 0}, {15, 5}, {35, 5}, {50, 0}}, 18, 32});
  return scene;
}

const Terrain& SmallTerrain() {
  static const Scene scene = SmallScene();
  static const Terrain terrain(scene, nullptr, {-200, -200, 200, 200}, 0.15, 2);
  return terrain;
}

// Where a ray first is inside a column, by tiny steps.
double DepthByMarching(const Terrain& terrain, const Eigen::Vector3d& origin,
                       const Eigen::Vector3d& direction, double begin, double end, double step) {
  for (double depth = begin; depth < end; depth += step) {
    const Eigen::Vector3d place =
        origin + depth * Eigen::Vector3d(direction.x(), direction.y(), -direction.z());
    const int x =
        static_cast<int>(std::floor(place.x() / terrain.texel_m() + 0.5)) - terrain.rect().x0;
    const int y =
        static_cast<int>(std::floor(place.y() / terrain.texel_m() + 0.5)) - terrain.rect().y0;
    if (x < 0 || y < 0 || x >= terrain.width() || y >= terrain.height()) return end;
    const std::size_t texel = static_cast<std::size_t>(y) * terrain.width() + x;
    const double top = Terrain::HeightMetres(terrain.heights()[texel]);
    const double underside = terrain.undersides()[texel] * Terrain::kUndersideUnit;
    if (place.z() <= 0 || (place.z() <= top && place.z() >= underside)) return depth;
  }
  return end;
}

TEST(RayCaster, FindsWhatAStepByStepSearchFinds) {
  const Terrain& terrain = SmallTerrain();
  Random random(11);
  int hits = 0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d origin(random.Uniform(-25, 25), random.Uniform(-25, 25),
                                 random.Uniform(9, 14));
    const Eigen::Vector3d aim(random.Uniform(-20, 20), random.Uniform(-20, 20),
                              random.Uniform(0, 6));
    Eigen::Vector3d direction = aim - origin;
    direction.z() = -direction.z();
    direction.normalize();
    const double expected = DepthByMarching(terrain, origin, direction, 0, 60, 0.002);
    const RayCaster caster(terrain, origin.head<2>(), origin.z());
    const Hit hit = caster.Cast(direction, 0, 60);
    if (expected >= 60) {
      EXPECT_TRUE(hit.kind == Hit::Kind::kNone || hit.depth > 50) << i;
      continue;
    }
    ++hits;
    ASSERT_NE(hit.kind, Hit::Kind::kNone) << i;
    EXPECT_LE(hit.depth, expected + 0.001) << i;
    if (hit.depth > expected - 0.004) continue;
    // The steps went over an edge: small ones do not.
    EXPECT_NEAR(DepthByMarching(terrain, origin, direction, hit.depth - 1e-3, expected, 1e-6),
                hit.depth, 1e-4)
        << i;
  }
  EXPECT_GT(hits, 350);
}

TEST(RayCaster, ABeamIsFreeAsLongAsAllItsRaysAre) {
  const Terrain& terrain = SmallTerrain();
  Random random(12);
  int flat = 0;
  int short_of_a_hit = 0;
  for (int i = 0; i < 2000; ++i) {
    const RayCaster caster(terrain, {random.Uniform(-20, 20), random.Uniform(-20, 20)},
                           random.Uniform(2, 40));
    const Eigen::Vector3d axis(random.Uniform(-1, 1), random.Uniform(-1, 1),
                               random.Uniform(-0.1, 1));
    const Eigen::Vector3d across = 0.05 * Eigen::Vector3d::Random();
    const Eigen::Vector3d down = 0.05 * Eigen::Vector3d::Random();
    const RayCaster::FreeWay way =
        caster.FreeWayOf({axis, axis + across, axis + down, axis + across + down}, 0, 60);
    for (int j = 0; j < 10; ++j) {
      const Eigen::Vector3d ray = axis + random.Uniform() * across + random.Uniform() * down;
      const Hit hit = caster.Cast(ray, 0, 60);
      if (hit.kind == Hit::Kind::kNone) continue;
      if (way.flat) {
        EXPECT_NEAR(hit.height, 0, 1e-3) << i;
        ++flat;
      } else {
        EXPECT_GE(hit.depth, way.depth - 1e-6) << i;
        if (way.depth > 0.5 * hit.depth) ++short_of_a_hit;
      }
    }
  }
  EXPECT_GT(flat, 500);
  EXPECT_GT(short_of_a_hit, 500);
}

TEST(RayCaster, SeesTheGroundUnderABridgeAndNotThroughItsDeck) {
  const Terrain& terrain = SmallTerrain();
  // From the side, 2 m above the ground, and from above.
  const RayCaster beside(terrain, {0, -24}, 2);
  const Hit under = beside.Cast(Eigen::Vector3d(0, 1, 0.2), 0, 60);
  EXPECT_EQ(under.kind, Hit::Kind::kBeneath);
  EXPECT_NEAR(under.depth, 10, 0.01);
  const RayCaster above(terrain, {0, -14}, 30);
  const Hit deck = above.Cast(Eigen::Vector3d(0, 0, 1), 0, 60);
  EXPECT_EQ(deck.kind, Hit::Kind::kTop);
  EXPECT_NEAR(deck.height, 5, 0.01);
}

TEST(Terrain, ATexelDoesNotDependOnTheRectangle) {
  const Scene scene = SmallScene();
  const Terrain part(scene, nullptr, {0, 0, 10, 10}, 0.15, 1);
  const Terrain& whole = SmallTerrain();
  ASSERT_LE(whole.rect().x0, part.rect().x0);
  ASSERT_GE(whole.rect().x1, part.rect().x1);
  // Shadows come from the sun's side, so only the far corner is sure to have all that casts them.
  const int margin = 45;
  int raised = 0;
  for (int y = part.rect().y0 + margin; y < part.rect().y1 - margin; ++y) {
    for (int x = part.rect().x0 + margin; x < part.rect().x1 - margin; ++x) {
      const auto index = [x, y](const Terrain& terrain) {
        return static_cast<std::size_t>(y - terrain.rect().y0) * terrain.width() +
               (x - terrain.rect().x0);
      };
      ASSERT_EQ(part.colours(0)[index(part)], whole.colours(0)[index(whole)]) << x << " " << y;
      ASSERT_EQ(part.heights()[index(part)], whole.heights()[index(whole)]) << x << " " << y;
      if (part.heights()[index(part)] > 0) ++raised;
    }
  }
  EXPECT_GT(raised, 0);
}

TEST(Land, ReachesAsFarAsTheGroundIsSeen) {
  FlightPlan plan = FindFlightPlan("valley");
  plan.width = 90;
  plan.height = 72;
  const Scene scene = BuildScene(plan);
  const CameraPath path(plan.camera, plan.width, plan.height, plan.seed);
  const Land land(scene, plan, path, 1, 2);
  const Camera camera = path.At(0);
  int seen = 0;
  for (double y = 0; y < plan.height; y += 0.1) {
    for (int x = 0; x < plan.width; x += 8) {
      const Eigen::Vector3d ray = camera.WorldFromPixel() * Eigen::Vector3d(x, y, 1);
      if (ray.z() <= 0 || camera.altitude_m / ray.z() >= land.levels().back().end_m) continue;
      double begin = 0;
      bool met = false;
      for (const Land::Level& level : land.levels()) {
        const RayCaster caster(*level.terrain, {camera.x_m, camera.y_m}, camera.altitude_m);
        met = met || caster.Cast(ray, begin, level.end_m).kind != Hit::Kind::kNone;
        begin = level.end_m;
      }
      EXPECT_TRUE(met) << x << " " << y;
      ++seen;
    }
  }
  EXPECT_GT(seen, 3000);
  EXPECT_GT(land.levels().back().end_m, 5000);
}

TEST(Clip, KeepsWhatLiesBeforeTheCamera) {
  Camera camera;
  camera.altitude_m = 10;
  camera.focal_px = 100;
  // Looks along +y, level: x right, y down is the drop, z ahead.
  camera.camera_from_world << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  using Piece = std::array<Eigen::Vector3d, 4>;
  const Piece ahead = {{{-1, 20, 10}, {1, 20, 10}, {1, 20, 12}, {-1, 20, 12}}};
  const Outline whole = VisibleOutline(camera, ahead, Eigen::Vector2d::Zero());
  ASSERT_EQ(whole.size(), 4U);
  EXPECT_NEAR((whole[0] - Eigen::Vector2d(-5, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((whole[2] - Eigen::Vector2d(5, -10)).norm(), 0, 1e-9);
  const Piece behind = {{{-1, -20, 10}, {1, -20, 10}, {1, -20, 12}, {-1, -20, 12}}};
  EXPECT_TRUE(VisibleOutline(camera, behind, Eigen::Vector2d::Zero()).empty());
  // A road from behind the camera to before it is seen below the horizon only.
  const Piece road = {{{-2, -50, 0}, {2, -50, 0}, {2, 50, 0}, {-2, 50, 0}}};
  const Outline seen = VisibleOutline(camera, road, Eigen::Vector2d::Zero());
  ASSERT_GE(seen.size(), 4U);
  for (const Eigen::Vector2d& point : seen) EXPECT_GE(point.y(), 19.9);
}

TEST(GroundPhoto, IsMirroredBeyondItsEdges) {
  cv::Mat picture(8, 8, CV_8UC3);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) picture.at<cv::Vec3b>(y, x) = cv::Vec3b(10 * x, 20 * y, 5);
  }
  const GroundPhoto photo(picture, 0.5);
  // Pixel (0, 0) has its centre at (-1.75, -1.75); the edge lies at -2.
  EXPECT_FLOAT_EQ(photo.At(-1.75, -1.75, 0.1)[0], 0);
  EXPECT_FLOAT_EQ(photo.At(-0.25, 0.75, 0.1)[0], 30);
  EXPECT_FLOAT_EQ(photo.At(-0.25, 0.75, 0.1)[1], 100);
  EXPECT_FLOAT_EQ(photo.At(-2.75, -1.75, 0.1)[0], photo.At(-1.25, -1.75, 0.1)[0]);
  EXPECT_FLOAT_EQ(photo.At(2.0 + 4.25, 0.75, 0.1)[0], photo.At(-2.25, 0.75, 0.1)[0]);
  EXPECT_THROW(GroundPhoto(picture, 0), std::invalid_argument);
  EXPECT_THROW(GroundPhoto(cv::Mat(8, 8, CV_8U), 1), std::invalid_argument);
}

FlightPlan ObliquePlan() {
  FlightPlan plan = FindFlightPlan("flight");
  plan.width = 160;
  plan.height = 120;
  plan.camera.altitude_m = 60;
  plan.camera.pixel_m = 0.12;
  plan.camera.tilt_deg = 74;
  plan.camera.yaw_deg = 90;
  plan.camera.yaw_rate_deg = 0;
  return plan;
}

void ExpectSameFrame(const Renderer& a, const Renderer& b, int frame) {
  EXPECT_EQ(cv::norm(a.Frame(frame), b.Frame(frame), cv::NORM_INF), 0) << frame;
  const FrameTruth one = a.Truth(frame);
  const FrameTruth other = b.Truth(frame);
  EXPECT_EQ(one.first_from_frame, other.first_from_frame);
  EXPECT_EQ(one.horizon, other.horizon);
  for (const auto boxes : {&FrameTruth::movers, &FrameTruth::decoys}) {
    ASSERT_EQ((one.*boxes).size(), (other.*boxes).size());
    for (std::size_t i = 0; i < (one.*boxes).size(); ++i) {
      EXPECT_EQ((one.*boxes)[i].id, (other.*boxes)[i].id);
      EXPECT_EQ((one.*boxes)[i].box.x, (other.*boxes)[i].box.x);
      EXPECT_EQ((one.*boxes)[i].box.width, (other.*boxes)[i].box.width);
      EXPECT_EQ((one.*boxes)[i].visible, (other.*boxes)[i].visible);
    }
  }
}

TEST(Renderer, ShortRunsShowTheSameFlight) {
  FlightPlan plan = FindFlightPlan("flight");
  plan.width = 160;
  plan.height = 120;
  const Renderer few(plan, 2, {}, 5);
  const Renderer more(plan, 2, {}, 60);
  for (const int frame : {0, 4}) ExpectSameFrame(few, more, frame);
  EXPECT_THROW(Renderer(plan, 1, {}, plan.frames + 1), std::invalid_argument);
}

TEST(Renderer, ShortRunsShowTheSameFlightToTheHorizon) {
  const Renderer few(ObliquePlan(), 2, {}, 3);
  const Renderer more(ObliquePlan(), 2, {}, 30);
  ExpectSameFrame(few, more, 2);
}

TEST(Renderer, TheSkyBeginsAtTheHorizon) {
  FlightPlan plan = ObliquePlan();
  plan.sensor.read_sigma = 0;
  plan.sensor.shot_gain = 0;
  plan.sensor.chroma_sigma = 0;
  const Renderer flight(plan, 2, {}, 1);
  const Eigen::Vector3d horizon = flight.Truth(0).horizon;
  EXPECT_NEAR(horizon.head<2>().norm(), 1, 1e-9);
  const cv::Mat frame = flight.Frame(0);
  int sky = 0;
  for (int y = 0; y < frame.rows; ++y) {
    for (int x = 0; x < frame.cols; ++x) {
      const double below = horizon.dot(Eigen::Vector3d(x, y, 1));
      const auto colour = frame.at<cv::Vec3b>(y, x);
      if (below < -3) {
        ++sky;
        EXPECT_GE(colour[0], colour[2] - 4) << x << " " << y;  // blue or white
      } else if (below > 70) {
        EXPECT_LT(colour[0], 200) << x << " " << y;
      }
    }
  }
  EXPECT_GT(sky, 300);
}

TEST(Renderer, APhotoReplacesTheGroundAndThingsStandOnIt) {
  FlightPlan plan = FindFlightPlan("flight");
  plan.width = 160;
  plan.height = 120;
  plan.ground = cv::Mat(64, 64, CV_8UC3, cv::Scalar(20, 30, 200));
  plan.ground_pixel_m = 0.2;
  const Renderer flight(plan, 2, {}, 1);
  const cv::Mat frame = flight.Frame(0);
  int red = 0;
  for (int y = 0; y < frame.rows; ++y) {
    for (int x = 0; x < frame.cols; ++x) {
      const auto colour = frame.at<cv::Vec3b>(y, x);
      if (colour[2] > 2.2 * colour[1]) ++red;
    }
  }
  EXPECT_GT(red, frame.rows * frame.cols / 2);
  EXPECT_LT(red, frame.rows * frame.cols * 97 / 100);
}

TEST(Shading, WaterGlitters) {
  Scene scene = SmallScene();
  scene.plots.push_back(
      {{{0, 0}, Eigen::Vector2d::UnitX(), 20, 20}, GroundKind::kWater, {90, 80, 60}});
  const Terrain terrain(scene, nullptr, {-100, -100, 100, 100}, 0.15, 2);
  const RayCaster caster(terrain, {0, 0}, 50);
  int changed = 0;
  int bright = 0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d ray(0.004 * (i % 20 - 10), 0.004 * (i / 20 - 10), 1);
    const Hit hit = caster.Cast(ray, 0, 100);
    const float now = Shading(scene, terrain, 1.0).At(hit, ray, 0.2).colour[1];
    const float later = Shading(scene, terrain, 1.04).At(hit, ray, 0.2).colour[1];
    if (now < 120) continue;
    ++bright;
    if (std::abs(now - later) > 15) ++changed;
  }
  EXPECT_GE(bright, 4);
  EXPECT_LE(bright, 100);
  EXPECT_GE(2 * changed, bright);
}

TEST(Shading, HazeGrowsToItsShare) {
  Sky sky;
  sky.haze_m = 1000;
  EXPECT_FLOAT_EQ(HazeShare(sky, 0), 0);
  EXPECT_NEAR(HazeShare(sky, 1000), 1 - std::exp(-1.0), 2e-3);
  EXPECT_NEAR(HazeShare(sky, 3000), 1 - std::exp(-3.0), 0.03);
  EXPECT_LE(HazeShare(sky, 1e9), 1);
}

TEST(VehicleMesh, PeopleAreUprightAndStride) {
  const VehicleLook look = {VehicleKind::kPerson, {90, 90, 90}, 0.5, 0.55, 1.8};
  Sun sun;
  sun.direction = Eigen::Vector3d(0, 0.6, 0.8);
  const auto shape = [&](double phase) {
    std::vector<Face> faces;
    AppendFaces(look, {{4, 5}, {1, 0}, 2.0, 0.0, phase}, sun, 1, faces);
    return faces;
  };
  double low = 1e9;
  double high = -1e9;
  double reach = 0;
  for (const Face& face : shape(0.35)) {
    for (const Eigen::Vector3d& corner : face.corners) {
      low = std::min(low, corner.z());
      high = std::max(high, corner.z());
      reach = std::max(reach, (corner.head<2>() - Eigen::Vector2d(4, 5)).norm());
    }
  }
  EXPECT_NEAR(low, 2, 0.1);
  EXPECT_NEAR(high, 3.8, 0.01);
  EXPECT_LT(reach, 0.6);
  EXPECT_GT((shape(0.0)[0].corners[0] - shape(0.35)[0].corners[0]).norm(), 0.1);
}

TEST(VehicleMesh, FlagsWave) {
  Flag flag;
  Sun sun;
  sun.direction = Eigen::Vector3d(0, 0.6, 0.8);
  std::vector<Face> now;
  std::vector<Face> later;
  AppendFaces(flag, 0, {}, sun, 1.0, now);
  AppendFaces(flag, 0, {}, sun, 1.12, later);
  ASSERT_EQ(now.size(), later.size());
  double most = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    most = std::max(most, (now[i].corners[1] - later[i].corners[1]).norm());
  }
  EXPECT_GT(most, 0.1);
  EXPECT_LT(most, 1.0);
  EXPECT_EQ(now[0].corners[0], later[0].corners[0]) << "at the pole";
}

}  // namespace
}  // namespace windhover::replay
