// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/registration_transform.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "service/vision/homography.h"

namespace windhover {
namespace {

using Matrix2x8d = Eigen::Matrix<double, 2, 8>;

Eigen::Matrix3d Conjugate(const Eigen::Matrix3d& new_from_old, const Eigen::Matrix3d& homography) {
  Eigen::Matrix3d result = new_from_old * homography * new_from_old.inverse();
  if (std::abs(result(2, 2)) > 0.0) result /= result(2, 2);
  return result;
}

// Derivative of where `homography` (h33 = 1) puts x by its first eight elements, row-major.
Matrix2x8d JacobianByElements(const Eigen::Matrix3d& homography, const Eigen::Vector2d& x) {
  const Eigen::Vector2d to = Project(homography, x);
  const double w = homography.row(2) * x.homogeneous();
  Matrix2x8d jacobian;
  jacobian << x.x(), x.y(), 1.0, 0.0, 0.0, 0.0, -to.x() * x.x(), -to.x() * x.y(),  //
      0.0, 0.0, 0.0, x.x(), x.y(), 1.0, -to.y() * x.x(), -to.y() * x.y();
  return jacobian / w;
}

Matrix8d JacobianOfCorners(const Eigen::Matrix3d& homography,
                           const std::array<Eigen::Vector2d, 4>& corners) {
  Matrix8d jacobian;
  for (int i = 0; i < 4; ++i) {
    jacobian.middleRows<2>(2 * i) = JacobianByElements(homography, corners[i]);
  }
  return jacobian;
}

// Derivative of where `homography` puts x by x.
Eigen::Matrix2d JacobianByPoint(const Eigen::Matrix3d& homography, const Eigen::Vector2d& x) {
  const Eigen::Vector2d to = Project(homography, x);
  const double w = homography.row(2) * x.homogeneous();
  return (homography.topLeftCorner<2, 2>() - to * homography.block<1, 2>(2, 0)) / w;
}

// Covariance of where the measured homography puts the new picture's corners in the new reference,
// to first order.
Matrix8d CovarianceInNewPicture(const FrameRegistration& old, const Eigen::Matrix3d& old_from_new,
                                const Eigen::Matrix3d& new_from_old_reference, int old_width,
                                int old_height, int new_width, int new_height) {
  if (old.corner_covariance.isZero(0.0)) return Matrix8d::Zero();
  const Eigen::Matrix3d& measured =
      old.anchor_from_frame ? *old.anchor_from_frame : old.previous_from_frame;
  std::array<Eigen::Vector2d, 4> corners = PictureCorners(new_width, new_height);
  for (Eigen::Vector2d& corner : corners) corner = Project(old_from_new, corner);
  Matrix8d new_by_old =
      JacobianOfCorners(measured, corners) *
      JacobianOfCorners(measured, PictureCorners(old_width, old_height)).inverse();
  for (int i = 0; i < 4; ++i) {
    const Eigen::Matrix2d scale =
        JacobianByPoint(new_from_old_reference, Project(measured, corners[i]));
    new_by_old.middleRows<2>(2 * i) = scale * new_by_old.middleRows<2>(2 * i).eval();
  }
  return new_by_old * old.corner_covariance * new_by_old.transpose();
}

}  // namespace

Eigen::Matrix3d ScaleOfPicture(double old_width, double old_height, double new_width,
                               double new_height) {
  const double x = new_width / old_width;
  const double y = new_height / old_height;
  Eigen::Matrix3d scale;
  scale << x, 0.0, 0.5 * x - 0.5, 0.0, y, 0.5 * y - 0.5, 0.0, 0.0, 1.0;
  return scale;
}

Eigen::Matrix3d CropOfPicture(double x, double y) {
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(0, 2) = -x;
  shift(1, 2) = -y;
  return shift;
}

FrameRegistration RegistrationInNewPicture(const FrameRegistration& registration,
                                           const Eigen::Matrix3d& new_from_old, int old_width,
                                           int old_height, int new_width, int new_height) {
  FrameRegistration result = registration;
  result.previous_from_frame = Conjugate(new_from_old, registration.previous_from_frame);
  if (registration.anchor_from_frame) {
    result.anchor_from_frame = Conjugate(new_from_old, *registration.anchor_from_frame);
  }
  result.residual_px *= std::sqrt(new_from_old(0, 0) * new_from_old(1, 1));
  result.corner_covariance =
      CovarianceInNewPicture(registration, new_from_old.inverse(), new_from_old, old_width,
                             old_height, new_width, new_height);
  return result;
}

FrameRegistration RegistrationOnScreen(const FrameRegistration& registration,
                                       const ScreenPose& pose, int width, int height) {
  FrameRegistration result = registration;
  result.anchor_number = pose.anchor_number;
  if (!pose.continues) {
    result.previous_from_frame.setIdentity();
    if (registration.anchor_from_frame) result.anchor_from_frame = Eigen::Matrix3d::Identity();
    result.corner_covariance.setZero();
    result.starts_segment = true;
    return result;
  }
  const Eigen::Matrix3d frame_from_screen = InverseHomography(pose.screen_from_frame);
  const Eigen::Matrix3d& to_screen = pose.reference_screen_from_reference;
  result.previous_from_frame = pose.previous_screen_from_screen;
  if (registration.anchor_from_frame) {
    const Eigen::Matrix3d anchor = to_screen * *registration.anchor_from_frame * frame_from_screen;
    result.anchor_from_frame = anchor / anchor(2, 2);
  }
  const Eigen::Vector2d centre(0.5 * (width - 1), 0.5 * (height - 1));
  result.residual_px *= std::sqrt(std::abs(JacobianByPoint(to_screen, centre).determinant()));
  result.corner_covariance = CovarianceInNewPicture(registration, frame_from_screen, to_screen,
                                                    width, height, width, height);
  return result;
}

}  // namespace windhover
