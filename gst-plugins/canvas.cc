// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace windhover {
namespace {

// Drawing functions take coordinates in 1/16 px.
constexpr int kFixedBits = 4;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
// Height of a capital letter at font scale 1, px.
constexpr double kFontHeight = 21.0;
constexpr Colour kRim = {12, 14, 18};
constexpr double kDarkShare = 0.35;

// OpenCV smooths edges on 1, 3 and 4 channels only.
int LineType(const cv::Mat& pixels) { return pixels.channels() == 2 ? cv::LINE_8 : cv::LINE_AA; }

int PlaneThickness(int thickness, int step) { return std::max(1, (thickness + step - 1) / step); }

}  // namespace

Canvas::Canvas(const GstVideoFrame& frame)
    : width_(GST_VIDEO_FRAME_WIDTH(&frame)), height_(GST_VIDEO_FRAME_HEIGHT(&frame)) {
  switch (GST_VIDEO_FRAME_FORMAT(&frame)) {
    case GST_VIDEO_FORMAT_GRAY8:
      AddPlane(frame, 0, 1, Content::kLuma, 1);
      break;
    case GST_VIDEO_FORMAT_NV12:
      AddPlane(frame, 0, 1, Content::kLuma, 1);
      AddPlane(frame, 1, 2, Content::kChroma, 2);
      break;
    case GST_VIDEO_FORMAT_I420:
      AddPlane(frame, 0, 1, Content::kLuma, 1);
      AddPlane(frame, 1, 1, Content::kBlueDifference, 2);
      AddPlane(frame, 2, 1, Content::kRedDifference, 2);
      break;
    case GST_VIDEO_FORMAT_BGR:
    case GST_VIDEO_FORMAT_BGRx:
      AddPlane(frame, 0, GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0), Content::kBgr, 1);
      break;
    case GST_VIDEO_FORMAT_RGB:
    case GST_VIDEO_FORMAT_RGBx:
      AddPlane(frame, 0, GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0), Content::kRgb, 1);
      break;
    default:
      throw std::invalid_argument("cannot draw on this video format");
  }
}

void Canvas::AddPlane(const GstVideoFrame& frame, int index, int channels, Content content,
                      int step) {
  Plane& plane = planes_[plane_count_++];
  plane.pixels = cv::Mat((height_ + step - 1) / step, (width_ + step - 1) / step, CV_8UC(channels),
                         GST_VIDEO_FRAME_PLANE_DATA(&frame, index),
                         GST_VIDEO_FRAME_PLANE_STRIDE(&frame, index));
  plane.content = content;
  plane.step = step;
}

cv::Scalar Canvas::ValueOf(const Colour& colour, Content content) {
  // ITU-R BT.601, video range.
  const auto [r, g, b] = colour;
  const double luma = 16.0 + (65.481 * r + 128.553 * g + 24.966 * b) / 255.0;
  const double blue_difference = 128.0 + (-37.797 * r - 74.203 * g + 112.0 * b) / 255.0;
  const double red_difference = 128.0 + (112.0 * r - 93.786 * g - 18.214 * b) / 255.0;
  switch (content) {
    case Content::kLuma:
      return {luma};
    case Content::kChroma:
      return {blue_difference, red_difference};
    case Content::kBlueDifference:
      return {blue_difference};
    case Content::kRedDifference:
      return {red_difference};
    case Content::kBgr:
      return {b, g, r, 255.0};
    case Content::kRgb:
      return {r, g, b, 255.0};
  }
  return {};
}

cv::Point Canvas::ToFixed(const Eigen::Vector2d& point, int step) {
  // Far outside the picture a line is cut off rather than drawn; keeps the numbers in range.
  const auto fixed = [step](double value) {
    const double in_plane = (std::clamp(value, -30000.0, 30000.0) + 0.5) / step - 0.5;
    return static_cast<int>(std::lround(in_plane * (1 << kFixedBits)));
  };
  return {fixed(point.x()), fixed(point.y())};
}

cv::Rect Canvas::Within(const cv::Rect& area, const Plane& plane) {
  const cv::Rect scaled(area.x / plane.step, area.y / plane.step,
                        (area.width + plane.step - 1) / plane.step,
                        (area.height + plane.step - 1) / plane.step);
  return scaled & cv::Rect(0, 0, plane.pixels.cols, plane.pixels.rows);
}

void Canvas::DrawLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Colour& colour,
                      int thickness) {
  if (!from.allFinite() || !to.allFinite()) return;
  for (Plane& plane : planes()) {
    cv::line(plane.pixels, ToFixed(from, plane.step), ToFixed(to, plane.step),
             ValueOf(colour, plane.content), PlaneThickness(thickness, plane.step),
             LineType(plane.pixels), kFixedBits);
  }
}

void Canvas::DrawRectangle(const Eigen::Vector2d& top_left, const Eigen::Vector2d& bottom_right,
                           const Colour& colour, int thickness) {
  if (!top_left.allFinite() || !bottom_right.allFinite()) return;
  for (Plane& plane : planes()) {
    cv::rectangle(plane.pixels, ToFixed(top_left, plane.step), ToFixed(bottom_right, plane.step),
                  ValueOf(colour, plane.content), PlaneThickness(thickness, plane.step),
                  LineType(plane.pixels), kFixedBits);
  }
}

void Canvas::FillRectangle(const cv::Rect& area, const Colour& colour) {
  for (Plane& plane : planes()) {
    plane.pixels(Within(area, plane)).setTo(ValueOf(colour, plane.content));
  }
}

void Canvas::FillCircle(const Eigen::Vector2d& centre, double radius, const Colour& colour) {
  for (Plane& plane : planes()) {
    const int fixed_radius = static_cast<int>(std::lround(radius / plane.step * (1 << kFixedBits)));
    cv::circle(plane.pixels, ToFixed(centre, plane.step), fixed_radius,
               ValueOf(colour, plane.content), cv::FILLED, LineType(plane.pixels), kFixedBits);
  }
}

void Canvas::Darken(const cv::Rect& area) {
  for (Plane& plane : planes()) {
    cv::Mat part = plane.pixels(Within(area, plane));
    // A fourth byte stays as it is: other elements may take it for opacity.
    cv::multiply(part, cv::Scalar(kDarkShare, kDarkShare, kDarkShare, 1.0), part);
    const double black = ValueOf({0, 0, 0}, plane.content)[0];
    if (black > 0.0) cv::add(part, cv::Scalar::all(black * (1.0 - kDarkShare)), part);
  }
}

void Canvas::DrawText(const Eigen::Vector2d& origin, const std::string& text, double letter_height,
                      const Colour& colour) {
  for (Plane& plane : planes()) {
    const double scale = letter_height / kFontHeight / plane.step;
    const cv::Point at(static_cast<int>(std::lround(origin.x() / plane.step)),
                       static_cast<int>(std::lround(origin.y() / plane.step)));
    const int type = LineType(plane.pixels);
    const int thickness = PlaneThickness(static_cast<int>(letter_height / 11.0), plane.step);
    cv::putText(plane.pixels, text, at, kFont, scale, ValueOf(kRim, plane.content), thickness + 2,
                type);
    cv::putText(plane.pixels, text, at, kFont, scale, ValueOf(colour, plane.content), thickness,
                type);
  }
}

double Canvas::TextWidth(const std::string& text, double letter_height) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, letter_height / kFontHeight, 1, &baseline).width;
}

}  // namespace windhover
