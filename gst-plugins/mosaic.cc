// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/mosaic.h"

#include <Eigen/LU>
#include <algorithm>

#include "gst-plugins/plane_warp.h"
#include "service/vision/homography.h"

namespace windhover {
namespace {

// The mosaic reaches this far around the screen. Even, for chroma planes.
constexpr int kMarginPx = 16;
// Closer than this, mosaic and screen are the same but for a shift by the margin.
constexpr double kAlignedPx = 0.02;

// Outermost pixels of the frame that are left out: cameras and codecs often spoil them, and in a
// mosaic they would stay behind as lines. Even, for chroma planes.
constexpr int kRimPx = 2;

Eigen::Matrix3d DiagonalShift(double distance_px) {
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift.topRightCorner<2, 1>().setConstant(distance_px);
  return shift;
}

// The farthest that a corner of the screen lies from where a mere margin would put it, px.
double Displacement(const Eigen::Matrix3d& mosaic_from_screen, const cv::Size& screen) {
  double largest = 0.0;
  for (const Eigen::Vector2d& x : PictureCorners(screen.width, screen.height)) {
    const Eigen::Vector2d shift = Project(mosaic_from_screen, x) - x;
    largest = std::max(largest, (shift.array() - kMarginPx).matrix().norm());
  }
  return largest;
}

// Of frames larger than the rim; registration takes no smaller ones.
cv::Mat WithoutRim(const cv::Mat& pixels, int rim) {
  return pixels({rim, rim, pixels.cols - 2 * rim, pixels.rows - 2 * rim});
}

cv::Rect ScreenIn(const PicturePlane& screen) {
  const int margin = kMarginPx / screen.step;
  return {margin, margin, screen.pixels.cols, screen.pixels.rows};
}

}  // namespace

void Mosaic::Prepare(const PicturePlanes& screen) {
  for (std::size_t i = 0; i < screen.size(); ++i) {
    const cv::Mat& like = screen[i].pixels;
    const int margins = 2 * kMarginPx / screen[i].step;
    planes_[i].pixels.create(like.rows + margins, like.cols + margins, like.type());
    planes_[i].spare.create(planes_[i].pixels.size(), like.type());
  }
  mosaic_from_screen_ = DiagonalShift(kMarginPx);
  is_empty_ = false;
}

void Mosaic::Follow(const Eigen::Matrix3d& previous_screen_from_screen,
                    const PicturePlanes& screen) {
  mosaic_from_screen_ = mosaic_from_screen_ * previous_screen_from_screen;
  mosaic_from_screen_ /= mosaic_from_screen_(2, 2);
  if (Displacement(mosaic_from_screen_, screen[0].pixels.size()) <= kMarginPx) return;
  const Eigen::Matrix3d new_from_old = DiagonalShift(kMarginPx) * mosaic_from_screen_.inverse();
  for (std::size_t i = 0; i < screen.size(); ++i) {
    WarpPlane(planes_[i].pixels, InPlane(new_from_old, screen[i].step), Outside::kFill,
              screen[i].black, planes_[i].spare);
    std::swap(planes_[i].pixels, planes_[i].spare);
  }
  mosaic_from_screen_ = DiagonalShift(kMarginPx);
}

void Mosaic::Show(const PicturePlanes& frame, const ScreenPose& pose, PicturePlanes& screen) {
  // The first frame is drawn as a whole, with black around it.
  const bool first = is_empty_;
  const int rim = first ? 0 : kRimPx;
  const Outside around = first ? Outside::kFill : Outside::kKeep;
  if (first) {
    Prepare(screen);
  } else {
    Follow(pose.previous_screen_from_screen, screen);
  }
  const bool aligned = Displacement(mosaic_from_screen_, screen[0].pixels.size()) <= kAlignedPx;
  const Eigen::Matrix3d screen_from_mosaic = mosaic_from_screen_.inverse();
  const Eigen::Matrix3d screen_from_inner = pose.screen_from_frame * DiagonalShift(rim);
  for (std::size_t i = 0; i < screen.size(); ++i) {
    const int step = screen[i].step;
    const cv::Mat inner = WithoutRim(frame[i].pixels, rim / step);
    cv::Mat& mosaic = planes_[i].pixels;
    WarpPlane(inner, InPlane(mosaic_from_screen_ * screen_from_inner, step), around,
              screen[i].black, mosaic);
    if (aligned) {
      mosaic(ScreenIn(screen[i])).copyTo(screen[i].pixels);
      continue;
    }
    WarpPlane(mosaic, InPlane(screen_from_mosaic, step), Outside::kFill, screen[i].black,
              screen[i].pixels);
    WarpPlane(inner, InPlane(screen_from_inner, step), Outside::kKeep, {}, screen[i].pixels);
  }
}

}  // namespace windhover
