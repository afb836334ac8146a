// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "replay/render/camera.h"
#include "replay/render/land.h"
#include "replay/render/vehicle_mesh.h"

namespace windhover::replay {

// A vehicle, a person or a flag at one instant, ready to be drawn.
struct DrawnBody {
  std::int64_t id = 0;
  std::vector<Face> faces;
  // The outline of its shadow on the ground, at `height_m`; empty where it casts none.
  std::vector<Eigen::Vector2d> shadow;
  double height_m = 0;
};

// Rows [first_row, first_row + rows) of the picture that a perfect camera takes in no time: one ray
// a pixel. Reused from picture to picture.
class View {
 public:
  View(int width, int rows);

  struct Instant {
    const Scene& scene;
    const Land& land;
    const Camera& camera;
    const std::vector<DrawnBody>& bodies;
    double time_s;
  };
  // Draws the land, then the bodies and their shadows, then the air. (shift_x, shift_y) px moves
  // the rays from the pixels' centres.
  void Draw(const Instant& instant, int first_row, double shift_x, double shift_y);

  struct Pixel {
    float blue = 0;
    float green = 0;
    float red = 0;
    float depth = 0;      // of what is seen there along the optical axis, m; infinite: sky
    float height = 0;     // of it over height 0, m
    float sun = 0;        // share of the sun that reaches it
    std::int64_t id = 0;  // of the body seen there; 0: none
  };
  const Pixel& at(int x, int row) const {
    return pixels_[static_cast<std::size_t>(row) * width_ + x];
  }
  int width() const { return width_; }
  int rows() const { return rows_; }

 private:
  class LandPainter;

  void DrawLand(const Instant& instant);
  void DrawShadow(const DrawnBody& body, const Instant& instant);
  void DrawFace(const Face& face, std::int64_t id, const Camera& camera);
  void DrawAir(const Instant& instant);
  Pixel& pixel(int x, int y) {
    return pixels_[static_cast<std::size_t>(y - first_row_) * width_ + x];
  }

  int width_;
  int rows_;
  int first_row_ = 0;
  // Directions of the rays: camera.WorldFromPixel() with the shift taken in. A ray's depth is along
  // the optical axis.
  Eigen::Matrix3d rays_ = Eigen::Matrix3d::Identity();
  double shift_x_ = 0;
  double shift_y_ = 0;
  std::vector<Pixel> pixels_;
};

}  // namespace windhover::replay
