// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/overlay_drawing.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <string>

namespace windhover {
namespace {

constexpr Colour kWhite = {240, 242, 245};
constexpr Colour kDark = {12, 14, 18};
constexpr Colour kGood = {70, 220, 110};
constexpr Colour kFair = {255, 190, 40};
constexpr Colour kBad = {255, 60, 50};

// Line width for a picture of this height: 2 px at 540 lines, 3 px at 1080.
int LineWidth(const Canvas& canvas) { return std::max(1, (canvas.height() + 360) / 420); }

double LetterHeight(const Canvas& canvas) { return std::clamp(canvas.height() / 54.0, 7.0, 40.0); }

// Neighbouring numbers get colours far apart: the hue turns by the golden angle.
Colour ColourOf(std::uint64_t track_id) {
  const double hue = std::fmod(static_cast<double>(track_id % 100000) * 0.61803398875, 1.0) * 6.0;
  const auto channel = [hue](double offset) {
    const double k = std::fmod(offset + hue, 6.0);
    return 255.0 * (1.0 - 0.75 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

Colour Mix(const Colour& a, const Colour& b, double share_of_b) {
  const auto mix = [share_of_b](double x, double y) { return x + (y - x) * share_of_b; };
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

Colour ColourOf(RegistrationQuality quality) {
  switch (quality) {
    case RegistrationQuality::kValid:
      return kGood;
    case RegistrationQuality::kDegraded:
      return kFair;
    case RegistrationQuality::kLost:
      return kBad;
  }
  return kBad;
}

std::string StatusText(const FrameRegistration& registration, int detections) {
  std::array<char, 160> text{};
  if (registration.quality == RegistrationQuality::kLost) {
    std::snprintf(text.data(), text.size(), "frame %" PRIu64 "  REGISTRATION LOST  %d/%d inliers",
                  registration.frame_number, registration.inliers, registration.tiles);
  } else {
    std::snprintf(text.data(), text.size(),
                  "frame %" PRIu64 "  %s  %d/%d inliers  %.2f px  overlap %.0f %%  %d moving",
                  registration.frame_number,
                  registration.quality == RegistrationQuality::kValid ? "valid" : "degraded",
                  registration.inliers, registration.tiles, registration.residual_px,
                  100.0 * registration.overlap, detections);
  }
  return text.data();
}

// The means of each point and its neighbours, for boxes jump from frame to frame with the seeds at
// their edges; of those too close together, the first.
void SmoothPath(const std::vector<Eigen::Vector2d>& points, std::vector<Eigen::Vector2d>& path) {
  constexpr std::size_t kNeighbours = 3;
  constexpr double kMinDistancePx = 3.0;
  path.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t reach = std::min({i, points.size() - 1 - i, kNeighbours});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t j = i - reach; j <= i + reach; ++j) sum += points[j];
    const Eigen::Vector2d mean = sum / static_cast<double>(2 * reach + 1);
    const bool last = i + 1 == points.size();
    if (path.empty() || last || (mean - path.back()).norm() >= kMinDistancePx) {
      path.push_back(mean);
    }
  }
}

// The object itself is left free of its trail.
bool Contains(const Box& box, const Eigen::Vector2d& point) {
  return point.x() >= box.x && point.x() < box.x + box.width && point.y() >= box.y &&
         point.y() < box.y + box.height;
}

void DrawFrame(int thickness, const Colour& colour, Canvas& canvas) {
  const int width = canvas.width();
  const int height = canvas.height();
  canvas.FillRectangle({0, 0, width, thickness}, colour);
  canvas.FillRectangle({0, height - thickness, width, thickness}, colour);
  canvas.FillRectangle({0, 0, thickness, height}, colour);
  canvas.FillRectangle({width - thickness, 0, thickness, height}, colour);
}

}  // namespace

void OverlayDrawing::Draw(const FrameRegistration* registration,
                          const std::vector<Detection>& detections, Canvas& canvas) {
  if (registration != nullptr && options_.trails) {
    trails_.Advance(*registration, detections);
    DrawTrails(canvas);
  }
  for (const Detection& detection : detections) DrawDetection(detection, canvas);
  if (registration == nullptr) return;
  if (options_.status) DrawStatus(*registration, static_cast<int>(detections.size()), canvas);
  if (registration->quality == RegistrationQuality::kLost) {
    DrawFrame(3 * LineWidth(canvas), kBad, canvas);
  }
}

void OverlayDrawing::DrawTrails(Canvas& canvas) {
  const int width = LineWidth(canvas);
  for (const Trails::Trail& trail : trails_.trails()) {
    SmoothPath(trail.points, path_);
    const Colour colour = ColourOf(trail.track_id);
    const double count = static_cast<double>(path_.size());
    for (std::size_t i = 1; i < path_.size(); ++i) {
      if (trail.seen && Contains(trail.box, path_[i])) continue;
      const double age = 1.0 - static_cast<double>(i) / count;
      canvas.DrawLine(path_[i - 1], path_[i], Mix(colour, kDark, 0.6 * age),
                      age < 0.5 ? width : std::max(1, width - 1));
    }
  }
}

void OverlayDrawing::DrawDetection(const Detection& detection, Canvas& canvas) const {
  const int width = LineWidth(canvas);
  const Box& box = detection.box;
  // The lines stand clear of the object.
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(width + 0.5);
  const Eigen::Vector2d top_left = Eigen::Vector2d(box.x, box.y) - margin;
  const Eigen::Vector2d bottom_right =
      Eigen::Vector2d(box.x + box.width - 1.0, box.y + box.height - 1.0) + margin;
  const Colour colour = ColourOf(detection.track_id);
  if (options_.boxes) {
    canvas.DrawRectangle(top_left, bottom_right, kDark, width + 2);
    canvas.DrawRectangle(top_left, bottom_right, colour, width);
  }
  if (!options_.ids) return;
  const double letters = 0.9 * LetterHeight(canvas);
  const std::string text = std::to_string(detection.track_id);
  Eigen::Vector2d origin(top_left.x(), top_left.y() - width - 2.0);
  if (origin.y() < letters) origin.y() = bottom_right.y() + width + 2.0 + letters;
  origin.x() =
      std::clamp(origin.x(), 0.0, std::max(0.0, canvas.width() - Canvas::TextWidth(text, letters)));
  canvas.DrawText(origin, text, letters, Mix(colour, kWhite, 0.4));
}

void OverlayDrawing::DrawStatus(const FrameRegistration& registration, int detections,
                                Canvas& canvas) const {
  const std::string text = StatusText(registration, detections);
  double letters = LetterHeight(canvas);
  // Smaller where the picture is too narrow for the line.
  letters *= std::min(1.0, canvas.width() / (Canvas::TextWidth(text, letters) + 4.0 * letters));
  const int strip = static_cast<int>(std::lround(2.2 * letters));
  const double middle = canvas.height() - 0.5 * strip;
  canvas.Darken({0, canvas.height() - strip, canvas.width(), strip});
  const Colour colour = ColourOf(registration.quality);
  canvas.FillCircle({letters * 1.5, middle - 0.5}, 0.45 * letters, colour);
  canvas.DrawText(
      {letters * 2.6, middle + 0.5 * letters}, text, letters,
      registration.quality == RegistrationQuality::kLost ? Mix(kBad, kWhite, 0.4) : kWhite);
}

}  // namespace windhover
