// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gst/video/video.h>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "gpu-kernels/backend.h"
#include "gst-plugins/element.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {

// How the lines of a test frame lie in memory.
enum class Layout {
  kTight,     // as the caps alone say
  kWithMeta,  // longer lines and a gap before each plane, told by a GstVideoMeta
};

// Video of a flight over a SyntheticGround, with one bright object that moves over it.
class TestVideo {
 public:
  // GRAY16 video holds kThermalBlack + kThermalGain * v for the grey value v, as a thermal camera
  // of 14 bits might.
  static constexpr int kThermalBlack = 7000;
  static constexpr int kThermalGain = 6;

  static constexpr GstClockTime kFrameTime = 40 * GST_MSECOND;
  static constexpr GstClockTime kFirstPts = 5 * GST_SECOND;

  TestVideo(int width, int height, GstVideoFormat format = GST_VIDEO_FORMAT_GRAY8,
            Layout layout = Layout::kTight);

  // Framerate 25/1, or 0/1.
  std::string Caps(bool with_framerate = true) const;
  const GstVideoInfo& info() const { return info_; }

  // Frame t: PTS kFirstPts + t * kFrameTime, duration kFrameTime, offset t.
  BufferPtr Frame(int t);
  // All pixels black.
  BufferPtr Black(int t);

  // In place of the usual flight; ground_from_frame of frame t. Nothing moves then.
  void SetCamera(std::function<Eigen::Matrix3d(int t)> camera) { camera_ = std::move(camera); }
  // Where frame t lies over the ground.
  Eigen::Matrix3d GroundFromFrame(int t) const;
  // Top left corner in frame t of the moving object of kObjectSide x kObjectSide px.
  static constexpr int kObjectSide = 8;
  Eigen::Vector2d ObjectInFrame(int t) const;

  // The grey values that frame t was made from.
  const GrayImage& Gray(int t);

 private:
  BufferPtr MakeBuffer(int t);
  void Fill(GstBuffer* buffer, const GrayImage* gray);

  GstVideoInfo info_;
  Layout layout_;
  std::shared_ptr<Backend> backend_ = Backend::Create("cpu");
  SyntheticGround ground_;
  std::function<Eigen::Matrix3d(int t)> camera_;
  GrayImage gray_;
};

}  // namespace windhover
