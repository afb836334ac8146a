// SPDX-License-Identifier: Apache-2.0
#include "replay/render/renderer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <unordered_map>

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

// The map's rectangle that any frame may show, or that may cast a shadow on it.
void FindReach(const CameraPath& path, const FlightPlan& plan, Eigen::Vector2d& low,
               Eigen::Vector2d& high) {
  constexpr double kMargin = 14;  // m
  low.setConstant(1e9);
  high.setConstant(-1e9);
  for (int frame = -1; frame <= plan.frames; ++frame) {
    const Eigen::Matrix3d ground = path.At(frame).GroundFromPixel();
    for (const int x : {0, plan.width - 1}) {
      for (const int y : {0, plan.height - 1}) {
        const Eigen::Vector2d spot = (ground * Eigen::Vector3d(x, y, 1)).hnormalized();
        low = low.cwiseMin(spot);
        high = high.cwiseMax(spot);
      }
    }
  }
  low.array() -= kMargin;
  high.array() += kMargin;
}

bool InPicture(const Camera& camera, const VehiclePose& pose, int width, int height) {
  const Eigen::Vector2d seen = camera.Project({pose.position.x(), pose.position.y(), 0});
  const double margin = 12 * camera.focal_px / camera.altitude_m;
  return seen.x() > -margin && seen.y() > -margin && seen.x() < width + margin &&
         seen.y() < height + margin;
}

DrawnVehicle Drawn(std::int64_t id, const VehicleLook& look, const VehiclePose& pose,
                   const Sun& sun, float sun_share) {
  DrawnVehicle vehicle = {id, {}, ShadowOutline(look, pose, sun)};
  AppendFaces(look, pose, sun, sun_share, vehicle.faces);
  return vehicle;
}

// Pixels that the whole vehicle would cover if nothing stood before it, also outside the picture.
int SilhouettePixels(const DrawnVehicle& vehicle, const Camera& camera) {
  Eigen::Vector2d low(1e9, 1e9);
  Eigen::Vector2d high(-1e9, -1e9);
  std::vector<std::array<Eigen::Vector2d, 4>> outlines;
  for (const Face& face : vehicle.faces) {
    std::array<Eigen::Vector2d, 4> outline{};
    for (int i = 0; i < 4; ++i) {
      outline[i] = camera.Project(face.corners[i]);
      low = low.cwiseMin(outline[i]);
      high = high.cwiseMax(outline[i]);
    }
    outlines.push_back(outline);
  }
  const int x0 = static_cast<int>(std::floor(low.x()));
  const int y0 = static_cast<int>(std::floor(low.y()));
  const int x1 = static_cast<int>(std::ceil(high.x())) + 1;
  const int y1 = static_cast<int>(std::ceil(high.y())) + 1;
  std::vector<bool> covered(static_cast<std::size_t>(x1 - x0) * (y1 - y0));
  for (const auto& outline : outlines) {
    ForEachPixelInside(outline, x0, x1, y0, y1, [&](int x, int y) {
      covered[static_cast<std::size_t>(y - y0) * (x1 - x0) + (x - x0)] = true;
    });
  }
  return static_cast<int>(std::count(covered.begin(), covered.end(), true));
}

struct Seen {
  int left = 1 << 30;
  int top = 1 << 30;
  int right = -1;
  int bottom = -1;
  int pixels = 0;
};

}  // namespace

Renderer::Renderer(const FlightPlan& plan, int threads, const std::function<void()>& go_on)
    : plan_(plan),
      scene_(BuildScene(plan)),
      camera_path_(plan.camera, plan.width, plan.height, plan.seed),
      traffic_(scene_, plan.traffic_density, plan.frames, plan.frame_rate_hz),
      sensor_(plan.sensor, plan.seed) {
  if (plan.width < 16 || plan.height < 16 || plan.frames < 1) {
    throw std::invalid_argument("a flight needs at least one frame of 16x16 px");
  }
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  FindReach(camera_path_, plan, low, high);
  const double texel_m = std::clamp(0.5 * camera_path_.pixel_m(), 0.06, 0.2);
  terrain_ = std::make_unique<const Terrain>(scene_, low, high, texel_m, threads, go_on);
  for (const ParkedVehicle& parked : scene_.parked) {
    parked_sun_.push_back(terrain_->SunAt(parked.position));
  }
}

std::vector<DrawnVehicle> Renderer::VehiclesAt(double time) const {
  const Camera camera = camera_path_.At(time);
  std::vector<DrawnVehicle> drawn;
  for (const Traffic::Vehicle& vehicle : traffic_.vehicles()) {
    const VehiclePose pose = traffic_.PoseAt(vehicle, time);
    if (!InPicture(camera, pose, plan_.width, plan_.height)) continue;
    drawn.push_back(
        Drawn(vehicle.id, vehicle.look, pose, scene_.sun, terrain_->SunAt(pose.position)));
  }
  const auto first_parked = static_cast<std::int64_t>(traffic_.vehicles().size()) + 1;
  for (std::size_t i = 0; i < scene_.parked.size(); ++i) {
    const ParkedVehicle& parked = scene_.parked[i];
    const VehiclePose pose = {parked.position, parked.forward};
    if (!InPicture(camera, pose, plan_.width, plan_.height)) continue;
    drawn.push_back(Drawn(first_parked + static_cast<std::int64_t>(i), parked.look, pose,
                          scene_.sun, parked_sun_[i]));
  }
  return drawn;
}

cv::Mat Renderer::Frame(int frame, std::int64_t without) const {
  std::array<Camera, kInstants> cameras;
  std::array<std::vector<DrawnVehicle>, kInstants> vehicles;
  for (int i = 0; i < kInstants; ++i) {
    const double time = frame + plan_.sensor.exposure_share * ((i + 0.5) / kInstants - 0.5);
    cameras[i] = camera_path_.At(time);
    vehicles[i] = VehiclesAt(time);
    for (DrawnVehicle& vehicle : vehicles[i]) {
      if (vehicle.id == without) vehicle.faces.clear();
    }
  }
  cv::Mat light(plan_.height, plan_.width, CV_32FC3);
  for (int first = 0; first < plan_.height; first += kBandRows) {
    const int rows = std::min(kBandRows, plan_.height - first);
    View view(plan_.width, rows);
    light.rowRange(first, first + rows).setTo(cv::Scalar::all(0));
    for (int i = 0; i < kInstants; ++i) {
      view.Draw(*terrain_, cameras[i], scene_.sun, vehicles[i], first, kPlaces[i][0],
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

bool Renderer::Moves(const Traffic::Vehicle& vehicle, int frame) const {
  // Seen by the camera of `frame` both times, so that only the vehicle's own way counts.
  const Camera camera = camera_path_.At(frame);
  const auto seen = [&](double time) {
    const Eigen::Vector2d spot = traffic_.PoseAt(vehicle, time).position;
    return camera.Project({spot.x(), spot.y(), 0});
  };
  const double half = 0.5 * kMoverWindowFrames;
  return (seen(frame + half) - seen(frame - half)).norm() >= kMoverTravelPx;
}

Eigen::Matrix3d Renderer::TrueHomography(int frame) const {
  if (frame == 0) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d first_from_frame =
      camera_path_.At(0).GroundFromPixel().inverse() * camera_path_.At(frame).GroundFromPixel();
  return first_from_frame / first_from_frame(2, 2);
}

FrameTruth Renderer::Truth(int frame) const {
  const Camera camera = camera_path_.At(frame);
  FrameTruth truth;
  truth.first_from_frame = TrueHomography(frame);
  const std::vector<DrawnVehicle> vehicles = VehiclesAt(frame);
  View view(plan_.width, plan_.height);
  view.Draw(*terrain_, camera, scene_.sun, vehicles, 0, 0, 0);
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
  for (const DrawnVehicle& vehicle : vehicles) {
    const Seen& one = seen[vehicle.id];
    if (one.pixels == 0) continue;
    const double visible =
        std::min(1.0, static_cast<double>(one.pixels) / SilhouettePixels(vehicle, camera));
    const int width = one.right - one.left + 1;
    const int height = one.bottom - one.top + 1;
    if (visible < kLeastVisible || std::min(width, height) < kLeastWidthPx) continue;
    const LabelledBox box = {frame + 1,
                             vehicle.id,
                             {static_cast<double>(one.left), static_cast<double>(one.top),
                              static_cast<double>(width), static_cast<double>(height)},
                             1.0,
                             visible};
    const auto index = static_cast<std::size_t>(vehicle.id - 1);
    const bool moves =
        index < traffic_.vehicles().size() && Moves(traffic_.vehicles()[index], frame);
    (moves ? truth.movers : truth.decoys).push_back(box);
  }
  return truth;
}

double Renderer::OffPlaneShare(int frame, int gap, double px) const {
  const Camera now = camera_path_.At(frame);
  const Camera then = camera_path_.At(frame + gap);
  const Eigen::Matrix3d ground_from_pixel = now.GroundFromPixel();
  View view(plan_.width, plan_.height);
  view.Draw(*terrain_, now, scene_.sun, {}, 0, 0, 0);
  int off = 0;
  for (int y = 0; y < plan_.height; ++y) {
    for (int x = 0; x < plan_.width; ++x) {
      const double height = view.at(x, y).height;
      const Eigen::Vector2d spot = (ground_from_pixel * Eigen::Vector3d(x, y, 1)).hnormalized();
      const Eigen::Vector2d up = (Eigen::Vector2d(now.x_m, now.y_m) - spot) / now.altitude_m;
      const Eigen::Vector2d point = spot + height * up;
      const Eigen::Vector2d error =
          then.Project({point.x(), point.y(), height}) - then.Project({spot.x(), spot.y(), 0});
      if (error.norm() > px) ++off;
    }
  }
  return static_cast<double>(off) / (plan_.width * plan_.height);
}

}  // namespace windhover::replay
