// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <span>
#include <string>

namespace windhover {

// 0 to 255 each.
struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
};

// A video frame to draw on, in the memory where it lies and in its own format, one of
// WINDHOVER_8_BIT_FORMATS (luma.h).
// Coordinates are those of the frame, px, pixel centres at integers; thicknesses are px.
class Canvas {
 public:
  // `frame` is mapped for reading and writing and outlives the canvas.
  explicit Canvas(const GstVideoFrame& frame);

  int width() const { return width_; }
  int height() const { return height_; }

  void DrawLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Colour& colour,
                int thickness);
  void DrawRectangle(const Eigen::Vector2d& top_left, const Eigen::Vector2d& bottom_right,
                     const Colour& colour, int thickness);
  void FillRectangle(const cv::Rect& area, const Colour& colour);
  void FillCircle(const Eigen::Vector2d& centre, double radius, const Colour& colour);
  // Lets the background of a text show through, but dark and pale.
  void Darken(const cv::Rect& area);
  // Bright letters of this height (of a capital), with a dark rim. `origin` is the bottom left
  // corner.
  void DrawText(const Eigen::Vector2d& origin, const std::string& text, double letter_height,
                const Colour& colour);
  // Width of that text, px.
  static double TextWidth(const std::string& text, double letter_height);

 private:
  // One plane of the frame: what its channels hold, and how many frame pixels one of its own spans.
  enum class Content { kLuma, kChroma, kBlueDifference, kRedDifference, kBgr, kRgb };
  struct Plane {
    cv::Mat pixels;
    Content content = Content::kLuma;
    int step = 1;
  };

  void AddPlane(const GstVideoFrame& frame, int index, int channels, Content content, int step);
  std::span<Plane> planes() { return {planes_.data(), plane_count_}; }
  static cv::Scalar ValueOf(const Colour& colour, Content content);
  static cv::Point ToFixed(const Eigen::Vector2d& point, int step);
  static cv::Rect Within(const cv::Rect& area, const Plane& plane);

  int width_ = 0;
  int height_ = 0;
  std::array<Plane, 3> planes_;
  std::size_t plane_count_ = 0;
};

}  // namespace windhover
