// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "service/vision/homography.h"

namespace windhover {

// Geometry of where a frame is shown on a screen of the frame's own size. A pose is a homography
// screen_from_frame, px.

// The homography that takes the corners of a picture of this size, in the order of PictureCorners,
// to these points. Not finite where the points determine none.
Eigen::Matrix3d HomographyOfCorners(const std::array<Eigen::Vector2d, 4>& corners, int width,
                                    int height);

// Between two homographies between pictures of this size: `a` for a share of 0, `b` for 1. Turns
// the shorter way; apart from that, the corners go straight.
Eigen::Matrix3d BlendHomographies(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b,
                                  double share_of_b, int width, int height);

// Share, 0 to 1, of picture b that picture a of the same size covers: exact, between the centres of
// the border pixels. Needs a homography that preserves the orientation.
double CoveredShare(const Eigen::Matrix3d& b_from_a, int width, int height);

// An enlargement about the picture's centre that cuts off `crop` of its width and height.
Eigen::Matrix3d CropAsPose(double crop, int width, int height);

// How much may be lost of a frame and of the screen by showing the frame elsewhere than at rest,
// where its middle fills the screen but for what is cut off all around.
class PoseLimits {
 public:
  // `max_uncovered`: share of the screen where there is no frame. `max_hidden`: share, of what is
  // seen of the frame at rest, that lies off the screen.
  PoseLimits(int width, int height, double crop, double max_uncovered, double max_hidden);

  const Eigen::Matrix3d& rest() const { return rest_; }

  bool Allow(const Eigen::Matrix3d& screen_from_frame) const;
  // The pose, where allowed; else what is allowed on the way from it to rest, and next to it. Rest
  // for poses that no frame can have, such as mirrored ones.
  Eigen::Matrix3d Restrict(const Eigen::Matrix3d& screen_from_frame) const;

 private:
  int width_;
  int height_;
  double max_uncovered_;
  double min_seen_;
  Eigen::Matrix3d rest_;
};

}  // namespace windhover
