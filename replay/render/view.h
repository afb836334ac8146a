// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "replay/render/camera.h"
#include "replay/render/terrain.h"
#include "replay/render/vehicle_mesh.h"

namespace windhover::replay {

// A vehicle at one instant, ready to be drawn.
struct DrawnVehicle {
  std::int64_t id = 0;
  std::vector<Face> faces;
  std::array<Eigen::Vector2d, 6> shadow;
};

// Rows [first_row, first_row + rows) of the picture that a perfect camera takes in no time: one ray
// a pixel. Reused from picture to picture.
class View {
 public:
  View(int width, int rows);

  // Draws the terrain, then the vehicles and their shadows. (shift_x, shift_y) px moves the rays
  // from the pixels' centres.
  void Draw(const Terrain& terrain, const Camera& camera, const Sun& sun,
            const std::vector<DrawnVehicle>& vehicles, int first_row, double shift_x,
            double shift_y);

  struct Pixel {
    float blue = 0;
    float green = 0;
    float red = 0;
    float height = 0;     // of what is seen there over the ground, m
    float sun = 0;        // share of the sun that reaches it
    std::int64_t id = 0;  // of the vehicle seen there; 0: none
  };
  const Pixel& at(int x, int row) const {
    return pixels_[static_cast<std::size_t>(row) * width_ + x];
  }
  int width() const { return width_; }
  int rows() const { return rows_; }

 private:
  void DrawTerrain(const Terrain& terrain, const Sun& sun, const Camera& camera);
  void DrawShadow(const DrawnVehicle& vehicle, const Sun& sun, const Camera& camera);
  void DrawFace(const Face& face, std::int64_t id, const Camera& camera);

  int width_;
  int rows_;
  int first_row_ = 0;
  // Directions of the rays: camera.WorldFromPixel() with the shift taken in.
  Eigen::Matrix3d rays_ = Eigen::Matrix3d::Identity();
  double shift_x_ = 0;
  double shift_y_ = 0;
  std::vector<Pixel> pixels_;
};

}  // namespace windhover::replay
