// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>

#include "gst-plugins/picture_planes.h"
#include "service/vision/stabilisation.h"

namespace windhover {

// What the frames up to now have shown on the screen and a little around it. The picture is kept in
// the coordinates of an earlier screen for as long as the present one lies close by: drawn anew for
// every frame it would blur, as each drawing interpolates.
class Mosaic {
 public:
  // Draws the frame where the pose puts it, and around it what earlier frames have shown; black
  // where none has. Both have the same format and size.
  void Show(const PicturePlanes& frame, const ScreenPose& pose, PicturePlanes& screen);
  // Forgets everything. The memory is kept.
  void Reset() { is_empty_ = true; }

 private:
  struct Plane {
    cv::Mat pixels;
    cv::Mat spare;  // of the same size
  };

  void Prepare(const PicturePlanes& screen);
  void Follow(const Eigen::Matrix3d& previous_screen_from_screen, const PicturePlanes& screen);

  bool is_empty_ = true;
  std::array<Plane, 3> planes_;
  Eigen::Matrix3d mosaic_from_screen_ = Eigen::Matrix3d::Identity();
};

}  // namespace windhover
