// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "service/vision/stabilisation.h"
#include "service/vision/types.h"

namespace windhover {

// The same registration told for another picture of the same frames, which `new_from_old` (affine,
// upright: a scale and a shift) makes from the old one: a scaled or cropped video. The anchor and
// the previous frame are taken to have been scaled and cropped in the same way.
//
// Homographies are conjugated: new_from_old * H * old_from_new. The corner covariance is carried
// over to first order from the old picture's corners to the new picture's, through the homography
// that four corners determine. The residual is multiplied by the geometric mean of the two scales.
// Frame numbers, counts, overlap and quality are what they were measured as on the old picture.
FrameRegistration RegistrationInNewPicture(const FrameRegistration& registration,
                                           const Eigen::Matrix3d& new_from_old, int old_width,
                                           int old_height, int new_width, int new_height);

// The registration of a frame, told for the stabilised picture that shows it: from this screen to
// those that showed the frame before and the anchor. Where the ground holds still on the screen,
// the homographies are close to the identity. A frame that does not continue the one shown before
// it starts a segment. `width` and `height` are the frame's and the screen's, px.
//
// The corner covariance is carried over as above, the residual multiplied by the scale of the
// screen that showed the reference. Counts, overlap and quality are what they were measured as.
FrameRegistration RegistrationOnScreen(const FrameRegistration& registration,
                                       const ScreenPose& pose, int width, int height);

// new_from_old of a picture scaled from one size to another. Pixel centres lie at integers, so that
// x_new + 0.5 = (x_old + 0.5) * new_width / old_width.
Eigen::Matrix3d ScaleOfPicture(double old_width, double old_height, double new_width,
                               double new_height);

// new_from_old of a picture whose top left pixel is the old picture's pixel (x, y).
Eigen::Matrix3d CropOfPicture(double x, double y);

}  // namespace windhover
