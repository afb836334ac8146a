// SPDX-License-Identifier: Apache-2.0
#include "replay/render/renderer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "replay/render/clip.h"
#include "replay/render/fill.h"

namespace windhover::replay {
namespace {

// Instants of the exposure, each with its own place within the pixel: a rank-1 lattice whose means
// are 0, so that neither motion blur nor antialiasing shifts the picture.
constexpr int kInstants = 8;
constexpr std::array<std::array<double, 2>, kInstants> kPlaces = {{{-0.4375, 0.0625},
                                                                   {0.0625, -0.1875},
                                                                   {0.3125, 0.3125},
                                                                   {-0.1875, -0.4375},
                                                                   {0.1875, 0.4375},
                                                                   {-0.3125, -0.3125},
                                                                   {-0.0625, 0.1875},
                                                                   {0.4375, -0.0625}}};
constexpr int kBandRows = 16;

// What is farther than this is too small to be drawn, m.
constexpr double kFarthestBody = 4000;
constexpr double kBodyReach = 12;  // m, of the largest body with its shadow

// Depth along the optical axis of a point (x, y, height), m.
double DepthOf(const Camera& camera, const Eigen::Vector3d& point) {
  return camera.camera_from_world.row(2).dot(Eigen::Vector3d(
      point.x() - camera.x_m, point.y() - camera.y_m, camera.altitude_m - point.z()));
}

bool InPicture(const Camera& camera, const Eigen::Vector3d& point, int width, int height) {
  const double depth = DepthOf(camera, point);
  if (depth < -kBodyReach || depth > kFarthestBody) return false;
  if (depth < 2 * kBodyReach) return true;
  const Eigen::Vector2d seen = camera.Project(point);
  const double margin = 1.5 * kBodyReach * camera.focal_px / depth;
  return seen.x() > -margin && seen.y() > -margin && seen.x() < width + margin &&
         seen.y() < height + margin;
}

// Pixels that the whole body would cover if nothing stood before it, also outside the picture.
int SilhouettePixels(const DrawnBody& body, const Camera& camera) {
  constexpr double kOutside = 4000;  // px
  Eigen::Vector2d low(kOutside, kOutside);
  Eigen::Vector2d high = -low;
  std::vector<Outline> outlines;
  for (const Face& face : body.faces) {
    outlines.push_back(VisibleOutline(camera, face.corners, Eigen::Vector2d::Zero()));
    for (const Eigen::Vector2d& point : outlines.back()) {
      low = low.cwiseMin(point.cwiseMax(-kOutside));
      high = high.cwiseMax(point.cwiseMin(kOutside));
    }
  }
  const int x0 = static_cast<int>(std::floor(low.x()));
  const int y0 = static_cast<int>(std::floor(low.y()));
  const int x1 = static_cast<int>(std::ceil(high.x())) + 1;
  const int y1 = static_cast<int>(std::ceil(high.y())) + 1;
  if (x1 <= x0 || y1 <= y0) return 0;
  std::vector<bool> covered(static_cast<std::size_t>(x1 - x0) * (y1 - y0));
  for (const Outline& outline : outlines) {
    ForEachPixelInside(outline, x0, x1, y0, y1, [&](int x, int y) {
      covered[static_cast<std::size_t>(y - y0) * (x1 - x0) + (x - x0)] = true;
    });
  }
  return static_cast<int>(std::count(covered.begin(), covered.end(), true));
}

// h33 = 1 where that is not small against the rest, else unit norm with a positive determinant.
Eigen::Matrix3d Normalised(const Eigen::Matrix3d& homography) {
  constexpr double kSmall = 1e-3;
  const double norm = homography.norm();
  if (std::abs(homography(2, 2)) > kSmall * norm) return homography / homography(2, 2);
  return homography / (homography.determinant() < 0 ? -norm : norm);
}

const FlightPlan& Checked(const FlightPlan& plan, int frames) {
  if (plan.width < 16 || plan.height < 16 || plan.frames < 1) {
    throw std::invalid_argument("a flight needs at least one frame of 16x16 px");
  }
  if (frames < 0 || frames > plan.frames) {
    throw std::invalid_argument("flight " + plan.number + " has " + std::to_string(plan.frames) +
                                " frames");
  }
  return plan;
}

// The times, in frames, at which the light of a frame is taken.
std::array<double, kInstants> InstantsOf(int frame, const SensorPlan& sensor) {
  std::array<double, kInstants> times{};
  for (int i = 0; i < kInstants; ++i) {
    times[i] = frame + sensor.exposure_share * ((i + 0.5) / kInstants - 0.5);
  }
  return times;
}

struct Seen {
  int left = 1 << 30;
  int top = 1 << 30;
  int right = -1;
  int bottom = -1;
  int pixels = 0;
};

}  // namespace

Renderer::Renderer(const FlightPlan& plan, int threads, const std::function<void()>& go_on,
                   int frames)
    : plan_(Checked(plan, frames)),
      scene_(BuildScene(plan)),
      camera_path_(plan.camera, plan.width, plan.height, plan.seed),
      traffic_(scene_, plan.traffic_density, plan.frames, plan.frame_rate_hz),
      land_(scene_, plan, camera_path_, frames > 0 ? frames : plan.frames, threads, go_on),
      sensor_(plan.sensor, plan.seed) {}

void Renderer::AddBody(std::int64_t id, const VehicleLook& look, VehiclePose pose,
                       const Camera& camera, std::vector<DrawnBody>& bodies) const {
  pose.height +=
      scene_.GroundAt(static_cast<float>(pose.position.x()), static_cast<float>(pose.position.y()));
  const Eigen::Vector3d point(pose.position.x(), pose.position.y(), pose.height);
  if (!InPicture(camera, point, plan_.width, plan_.height)) return;
  const float sun = land_.SunAt(pose.position, DepthOf(camera, point));
  DrawnBody body = {id, {}, ShadowOutline(look, pose, scene_.sun), pose.height};
  AppendFaces(look, pose, scene_.sun, sun, body.faces);
  bodies.push_back(std::move(body));
}

std::vector<DrawnBody> Renderer::BodiesAt(double time) const {
  const Camera camera = camera_path_.At(time);
  std::vector<DrawnBody> bodies;
  for (const Traffic::Vehicle& vehicle : traffic_.vehicles()) {
    AddBody(vehicle.id, vehicle.look, traffic_.PoseAt(vehicle, time), camera, bodies);
  }
  const auto first_parked = static_cast<std::int64_t>(traffic_.vehicles().size()) + 1;
  for (std::size_t i = 0; i < scene_.parked.size(); ++i) {
    const ParkedVehicle& parked = scene_.parked[i];
    AddBody(first_parked + static_cast<std::int64_t>(i), parked.look,
            {parked.position, parked.forward}, camera, bodies);
  }
  for (const Flag& flag : scene_.flags) {
    const Eigen::Vector3d top(flag.foot.x(), flag.foot.y(), flag.height);
    if (!InPicture(camera, top, plan_.width, plan_.height)) continue;
    DrawnBody body;
    const float foot =
        scene_.GroundAt(static_cast<float>(flag.foot.x()), static_cast<float>(flag.foot.y()));
    AppendFaces(flag, foot, scene_.wind, scene_.sun, Seconds(time), body.faces);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

cv::Mat Renderer::Frame(int frame, std::int64_t without) const {
  std::array<Camera, kInstants> cameras;
  std::array<std::vector<DrawnBody>, kInstants> bodies;
  const std::array<double, kInstants> times = InstantsOf(frame, plan_.sensor);
  for (int i = 0; i < kInstants; ++i) {
    cameras[i] = camera_path_.At(times[i]);
    bodies[i] = BodiesAt(times[i]);
    for (DrawnBody& body : bodies[i]) {
      if (without != 0 && body.id == without) body.faces.clear();
    }
  }
  cv::Mat light(plan_.height, plan_.width, CV_32FC3);
  for (int first = 0; first < plan_.height; first += kBandRows) {
    const int rows = std::min(kBandRows, plan_.height - first);
    View view(plan_.width, rows);
    light.rowRange(first, first + rows).setTo(cv::Scalar::all(0));
    for (int i = 0; i < kInstants; ++i) {
      view.Draw({scene_, land_, cameras[i], bodies[i], Seconds(times[i])}, first, kPlaces[i][0],
                kPlaces[i][1]);
      for (int row = 0; row < rows; ++row) {
        auto* sum = light.ptr<float>(first + row);
        for (int x = 0; x < plan_.width; ++x) {
          const View::Pixel& pixel = view.at(x, row);
          sum[3 * x] += pixel.blue * (1.0F / kInstants);
          sum[3 * x + 1] += pixel.green * (1.0F / kInstants);
          sum[3 * x + 2] += pixel.red * (1.0F / kInstants);
        }
      }
    }
  }
  return sensor_.Expose(light, frame);
}

Camera Renderer::TrueCamera(int frame) const {
  return camera_path_.Mean(InstantsOf(frame, plan_.sensor));
}

bool Renderer::Moves(const Traffic::Vehicle& vehicle, int frame) const {
  // Seen by the camera of `frame` both times, so that only the vehicle's own way counts.
  const Camera camera = TrueCamera(frame);
  const auto seen = [&](double time) {
    const VehiclePose pose = traffic_.PoseAt(vehicle, time);
    return camera.Project({pose.position.x(), pose.position.y(), pose.height});
  };
  const double half = 0.5 * kMoverWindowFrames;
  return (seen(frame + half) - seen(frame - half)).norm() >= kMoverTravelPx;
}

Eigen::Matrix3d Renderer::TrueHomography(int frame) const {
  if (frame == 0) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d first_from_frame =
      TrueCamera(0).GroundFromPixel().inverse() * TrueCamera(frame).GroundFromPixel();
  return Normalised(first_from_frame);
}

FrameTruth Renderer::Truth(int frame) const {
  const Camera camera = TrueCamera(frame);
  FrameTruth truth;
  truth.first_from_frame = TrueHomography(frame);
  truth.horizon = camera.Horizon();
  const std::vector<DrawnBody> bodies = BodiesAt(frame);
  View view(plan_.width, plan_.height);
  view.Draw({scene_, land_, camera, bodies, Seconds(frame)}, 0, 0, 0);
  std::unordered_map<std::int64_t, Seen> seen;
  for (int y = 0; y < plan_.height; ++y) {
    for (int x = 0; x < plan_.width; ++x) {
      const std::int64_t id = view.at(x, y).id;
      if (id == 0) continue;
      Seen& one = seen[id];
      one.left = std::min(one.left, x);
      one.top = std::min(one.top, y);
      one.right = std::max(one.right, x);
      one.bottom = std::max(one.bottom, y);
      ++one.pixels;
    }
  }
  for (const DrawnBody& body : bodies) {
    if (body.id == 0) continue;
    const Seen& one = seen[body.id];
    if (one.pixels == 0) continue;
    const double visible =
        std::min(1.0, static_cast<double>(one.pixels) / SilhouettePixels(body, camera));
    const int width = one.right - one.left + 1;
    const int height = one.bottom - one.top + 1;
    const bool counts = visible >= kLeastVisible;
    if (visible < kLeastMarked || std::min(width, height) < kLeastWidthPx) continue;
    const LabelledBox box = {frame + 1,
                             body.id,
                             {static_cast<double>(one.left), static_cast<double>(one.top),
                              static_cast<double>(width), static_cast<double>(height)},
                             counts ? 1.0 : 0.0,
                             visible};
    const auto index = static_cast<std::size_t>(body.id - 1);
    const bool moves =
        index < traffic_.vehicles().size() && Moves(traffic_.vehicles()[index], frame);
    if (moves || counts) (moves ? truth.movers : truth.decoys).push_back(box);
  }
  return truth;
}

double Renderer::OffPlaneShare(int frame, int gap, double px) const {
  const Camera now = TrueCamera(frame);
  const Camera then = TrueCamera(frame + gap);
  const Eigen::Matrix3d then_from_now = then.GroundFromPixel().inverse() * now.GroundFromPixel();
  const Eigen::Matrix3d rays = now.WorldFromPixel();
  View view(plan_.width, plan_.height);
  view.Draw({scene_, land_, now, {}, Seconds(frame)}, 0, 0, 0);
  int off = 0;
  int land = 0;
  for (int y = 0; y < plan_.height; ++y) {
    for (int x = 0; x < plan_.width; ++x) {
      const double depth = view.at(x, y).depth;
      if (!std::isfinite(depth)) continue;
      ++land;
      const Eigen::Vector3d pixel(x, y, 1);
      const Eigen::Vector3d way = depth * (rays * pixel);
      const Eigen::Vector3d point(now.x_m + way.x(), now.y_m + way.y(), now.altitude_m - way.z());
      const Eigen::Vector3d ground = then_from_now * pixel;
      if (way.z() <= 0 || DepthOf(then, point) <= 0 ||
          (then.Project(point) - ground.hnormalized()).norm() > px) {
        ++off;
      }
    }
  }
  return land == 0 ? 0.0 : static_cast<double>(off) / land;
}

}  // namespace windhover::replay
