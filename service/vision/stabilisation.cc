// SPDX-License-Identifier: Apache-2.0
#include "service/vision/stabilisation.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace windhover {
namespace {

// However fast the camera, in anchor mode: this many times the share that calls for centring anew.
constexpr double kHardLimit = 2.0;

const StabilisationOptions& Checked(const StabilisationOptions& options) {
  CheckOptions(options);
  return options;
}

PoseLimits ComfortLimits(int width, int height, const StabilisationOptions& o) {
  return {width, height, o.crop, o.max_off_screen, o.max_off_screen};
}

PoseLimits Bounds(int width, int height, const StabilisationOptions& o) {
  if (o.mode == StabilisationMode::kAnchor) {
    const double share = std::min(kHardLimit * o.max_off_screen, 0.9);
    return {width, height, o.crop, share, share};
  }
  return {width, height, o.crop, o.crop > 0.0 ? 0.0 : o.max_off_screen, o.max_off_screen};
}

Eigen::Matrix3d Normalised(const Eigen::Matrix3d& homography) {
  return homography / homography(2, 2);
}

// From 0 to 1 with no speed at either end.
double SmoothStep(double t) { return t * t * (3.0 - 2.0 * t); }

// Weighted moments over time of where the four corners lie, for a linear regression.
class CornerRegression {
 public:
  void Add(double time, double weight, const std::array<Eigen::Vector2d, 4>& corners) {
    weights_ += weight;
    times_ += weight * time;
    squares_ += weight * time * time;
    for (int i = 0; i < 4; ++i) {
      sums_[i] += weight * corners[i];
      products_[i] += weight * time * corners[i];
    }
  }
  // Where the line puts the corners at time 0.
  std::array<Eigen::Vector2d, 4> AtZero() const {
    const double determinant = weights_ * squares_ - times_ * times_;
    std::array<Eigen::Vector2d, 4> corners;
    for (int i = 0; i < 4; ++i) {
      corners[i] = determinant > 1e-9 * weights_ * weights_
                       ? ((squares_ * sums_[i] - times_ * products_[i]) / determinant).eval()
                       : (sums_[i] / weights_).eval();
    }
    return corners;
  }

 private:
  double weights_ = 0.0;
  double times_ = 0.0;
  double squares_ = 0.0;
  std::array<Eigen::Vector2d, 4> sums_{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                       Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  std::array<Eigen::Vector2d, 4> products_ = sums_;
};

}  // namespace

Stabilisation::Stabilisation(int width, int height, const StabilisationOptions& options,
                             double frame_rate_hz)
    : width_(width),
      height_(height),
      mode_(Checked(options).mode),
      smoothing_frames_(
          std::max(2, static_cast<int>(std::lround(options.smoothing_s * frame_rate_hz)))),
      lookahead_(mode_ == StabilisationMode::kSmooth
                     ? std::min(options.smoothing_lookahead, smoothing_frames_)
                     : 0),
      comfort_(ComfortLimits(width, height, options)),
      bounds_(Bounds(width, height, options)),
      path_(smoothing_frames_, lookahead_),
      glide_frames_(smoothing_frames_) {}

void Stabilisation::Push(const FrameRegistration& registration) {
  draining_ = false;
  path_.Push(registration);
}

std::optional<ScreenPose> Stabilisation::Pop() {
  if (path_.ahead() <= (draining_ ? 0 : lookahead_)) return std::nullopt;
  path_.Advance();
  const Eigen::Matrix3d& rest = bounds_.rest();
  const bool lost = has_shown_ && !path_.current().previous_from_frame;
  const Eigen::Matrix3d aimed =
      mode_ == StabilisationMode::kAnchor ? FollowGround() : SmoothedPose();
  // The same place on the screen for the first frame of unknown ground, whatever is on it.
  if (lost) StartGlide(rest.inverse() * shown_, aimed);
  const Eigen::Matrix3d wanted = rest * Glide(aimed);
  const ScreenPose pose = Describe(Normalised(bounds_.Restrict(wanted)));
  if (mode_ == StabilisationMode::kAnchor && glide_frames_ >= smoothing_frames_ &&
      !comfort_.Allow(shown_)) {
    held_ = PredictedPose();
    StartGlide(rest.inverse() * shown_, held_);
  }
  return pose;
}

void Stabilisation::Reset() {
  path_.Reset();
  draining_ = false;
  has_shown_ = false;
  glide_frames_ = smoothing_frames_;
}

Eigen::Matrix3d Stabilisation::FollowGround() {
  const auto& previous_from_frame = path_.current().previous_from_frame;
  if (previous_from_frame) {
    held_ = Normalised(held_ * *previous_from_frame);
  } else {
    held_.setIdentity();
  }
  return held_;
}

Eigen::Matrix3d Stabilisation::SmoothedPose() const {
  const auto picture = PictureCorners(width_, height_);
  const Eigen::Vector2d centre(0.5 * (width_ - 1), 0.5 * (height_ - 1));
  CornerRegression regression;
  regression.Add(0.0, 1.0, picture);
  const auto add = [&](int frames, const Eigen::Matrix3d& current_from_other) {
    // Pictures that far off say nothing of how this one should lie.
    if (!IsOrientationPreserving(current_from_other, width_, height_) ||
        (Project(current_from_other, centre) - centre).norm() > 2.0 * width_) {
      return false;
    }
    std::array<Eigen::Vector2d, 4> corners = picture;
    for (Eigen::Vector2d& x : corners) x = Project(current_from_other, x);
    const double standard_deviations = 2.0 * frames / smoothing_frames_;
    regression.Add(frames, std::exp(-0.5 * standard_deviations * standard_deviations), corners);
    return true;
  };
  path_.VisitPast(add);
  path_.VisitFuture(add);
  return InverseHomography(HomographyOfCorners(regression.AtZero(), width_, height_));
}

// Centred on the frame that the camera will show at the end of a glide, if it goes on as it did.
Eigen::Matrix3d Stabilisation::PredictedPose() const {
  Eigen::Matrix3d predicted = Eigen::Matrix3d::Identity();
  path_.VisitPast([&](int, const Eigen::Matrix3d& current_from_past) {
    if (!bounds_.Allow(bounds_.rest() * current_from_past)) return false;
    predicted = current_from_past;
    return true;
  });
  return predicted;
}

void Stabilisation::StartGlide(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  glide_start_ = Normalised(from * to.inverse());
  glide_frames_ = IsOrientationPreserving(glide_start_, width_, height_) ? 0 : smoothing_frames_;
}

Eigen::Matrix3d Stabilisation::Glide(const Eigen::Matrix3d& pose) {
  if (glide_frames_ >= smoothing_frames_) return pose;
  const double done = SmoothStep(static_cast<double>(glide_frames_++) / smoothing_frames_);
  return BlendHomographies(glide_start_, Eigen::Matrix3d::Identity(), done, width_, height_) * pose;
}

ScreenPose Stabilisation::Describe(const Eigen::Matrix3d& screen_from_frame) {
  const CameraPath::Step& step = path_.current();
  ScreenPose pose;
  pose.screen_from_frame = screen_from_frame;
  pose.continues = has_shown_ && step.previous_from_frame.has_value();
  if (has_shown_) {
    const Eigen::Matrix3d previous_from_frame =
        step.previous_from_frame.value_or(Eigen::Matrix3d::Identity());
    pose.previous_screen_from_screen =
        Normalised(shown_ * previous_from_frame * screen_from_frame.inverse());
  }
  if (step.anchor_from_frame) {
    if (!pose.continues) {
      anchor_shown_number_ = step.frame_number;
      anchor_screen_from_anchor_ =
          Normalised(screen_from_frame * step.anchor_from_frame->inverse());
    } else if (step.anchor_number == shown_number_) {
      anchor_shown_number_ = shown_number_;
      anchor_screen_from_anchor_ = shown_;
    }
    pose.reference_screen_from_reference = anchor_screen_from_anchor_;
    pose.anchor_number = anchor_shown_number_;
  } else {
    pose.reference_screen_from_reference = shown_;
    pose.anchor_number = step.anchor_number;
  }
  has_shown_ = true;
  shown_number_ = step.frame_number;
  shown_ = screen_from_frame;
  return pose;
}

}  // namespace windhover
