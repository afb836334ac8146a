// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/frame_differencing.h"

#include <opencv2/imgproc.hpp>

#include "replay/baselines/opencv_matrix.h"

namespace windhover::replay {

cv::Mat DifferenceMap(const cv::Mat& gray, const cv::Mat& previous,
                      const Eigen::Matrix3d& previous_from_frame, int threshold) {
  const cv::Matx33d matrix = ToOpenCv(previous_from_frame);
  const int flags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  cv::Mat registered;
  cv::warpPerspective(previous, registered, matrix, gray.size(), flags);
  // Bilinear samples within a pixel of the border are mixed with nothing: they are seen by less
  // than the whole.
  cv::Mat seen;
  const cv::Mat all(previous.size(), CV_8UC1, cv::Scalar(255));
  cv::warpPerspective(all, seen, matrix, gray.size(), flags);
  cv::Mat difference;
  cv::absdiff(gray, registered, difference);
  return (difference >= threshold) & (seen == 255);
}

FrameDifferencing::FrameDifferencing(const BackgroundOptions& background,
                                     const MotionOptions& motion)
    : threshold_(background.threshold), motion_(motion) {}

std::vector<MovingObject> FrameDifferencing::Detect(const cv::Mat& gray,
                                                    const FrameRegistration& registration) {
  const cv::Mat previous = previous_;
  previous_ = gray.clone();
  if (previous.empty() || registration.starts_segment) return {};
  return ExtractObjects(DifferenceMap(gray, previous, registration.previous_from_frame, threshold_),
                        motion_);
}

}  // namespace windhover::replay
