// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/stabilized_mog2.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "replay/baselines/opencv_matrix.h"
#include "service/vision/homography.h"

namespace windhover::replay {
namespace {

constexpr int kHistory = 50;            // frames
constexpr double kVarianceFactor = 16;  // OpenCV's default
// A pixel has a background when it has been seen for so many frames.
constexpr int kLeastSeen = 10;
constexpr std::size_t kHeldFrames = 20;
// Share of the frame that may lie beside the canvas.
constexpr double kLeastOnCanvas = 0.98;

}  // namespace

void StabilizedMog2::LayCanvas(const cv::Mat& gray) {
  model_ = cv::createBackgroundSubtractorMOG2(kHistory, kVarianceFactor, false);
  canvas_ = cv::Mat::zeros(2 * gray.rows, 2 * gray.cols, CV_8UC1);
  times_seen_ = cv::Mat::zeros(canvas_.size(), CV_8UC1);
  canvas_from_frame_.setIdentity();
  canvas_from_frame_.topRightCorner<2, 1>() << gray.cols / 2, gray.rows / 2;
  // The held frames lie before this one.
  Eigen::Matrix3d canvas_from_held = canvas_from_frame_;
  std::vector<Eigen::Matrix3d> poses(held_.size());
  for (std::size_t i = held_.size(); i-- > 0;) {
    canvas_from_held = canvas_from_held * held_[i].next_from_frame;
    poses[i] = canvas_from_held;
  }
  for (std::size_t i = 0; i < held_.size(); ++i) Teach(held_[i].gray, poses[i]);
}

bool StabilizedMog2::IsOnCanvas() const {
  const int width = canvas_.cols / 2;
  const int height = canvas_.rows / 2;
  return IsOrientationPreserving(canvas_from_frame_, width, height) &&
         OverlapShare(canvas_from_frame_, width, height, canvas_.cols, canvas_.rows) >=
             kLeastOnCanvas;
}

void StabilizedMog2::Teach(const cv::Mat& gray, const Eigen::Matrix3d& canvas_from_frame) {
  const cv::Matx33d matrix = ToOpenCv(canvas_from_frame);
  const cv::Mat all(gray.size(), CV_8UC1, cv::Scalar(255));
  cv::Mat seen;
  cv::warpPerspective(all, seen, matrix, canvas_.size(), cv::INTER_LINEAR);
  cv::Mat registered;
  cv::warpPerspective(gray, registered, matrix, canvas_.size(), cv::INTER_LINEAR);
  const cv::Mat wholly_seen = seen == 255;
  registered.copyTo(canvas_, wholly_seen);
  cv::add(times_seen_, 1, times_seen_, wholly_seen);
  model_->apply(canvas_, foreground_);
  foreground_ &= wholly_seen & (times_seen_ >= kLeastSeen);
}

std::vector<MovingObject> StabilizedMog2::Detect(const cv::Mat& gray,
                                                 const FrameRegistration& registration) {
  if (registration.starts_segment || canvas_.empty()) {
    held_.clear();
    LayCanvas(gray);
  } else {
    held_.back().next_from_frame = registration.previous_from_frame.inverse();
    canvas_from_frame_ = canvas_from_frame_ * registration.previous_from_frame;
    canvas_from_frame_ /= canvas_from_frame_(2, 2);
    if (!IsOnCanvas()) LayCanvas(gray);
  }
  Teach(gray, canvas_from_frame_);
  held_.push_back({gray.clone()});
  if (held_.size() > kHeldFrames) held_.pop_front();
  cv::Mat map;
  cv::warpPerspective(foreground_, map, ToOpenCv(canvas_from_frame_), gray.size(),
                      cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  return ExtractObjects(map, motion_);
}

}  // namespace windhover::replay
