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
  if (registration.corner_covariance.isZero(0.0)) return result;

  const Eigen::Matrix3d old_from_new = new_from_old.inverse();
  std::array<Eigen::Vector2d, 4> corners = PictureCorners(new_width, new_height);
  for (Eigen::Vector2d& corner : corners) corner = Project(old_from_new, corner);
  const Eigen::Matrix3d& measured = registration.anchor_from_frame
                                        ? *registration.anchor_from_frame
                                        : registration.previous_from_frame;
  Matrix8d new_by_old =
      JacobianOfCorners(measured, corners) *
      JacobianOfCorners(measured, PictureCorners(old_width, old_height)).inverse();
  for (int i = 0; i < 8; ++i) new_by_old.row(i) *= new_from_old(i % 2, i % 2);
  result.corner_covariance = new_by_old * registration.corner_covariance * new_by_old.transpose();
  return result;
}

}  // namespace windhover
