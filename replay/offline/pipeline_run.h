// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

typedef struct _GstBuffer GstBuffer;

namespace windhover::replay {

// Name and value, e.g. {"reference", "centre"}; goes to every element of ours that has a property
// of that name.
using PipelineOption = std::pair<std::string, std::string>;

// Elements of one pipeline and how they are set.
struct PipelineSettings {
  std::string elements;  // in gst-launch's syntax, from after the source to before the sink
  std::vector<PipelineOption> options;
};

// Plays frames that lie in memory through a GStreamer pipeline as fast as it takes them, and calls
// `leave` with each buffer that comes out, on the pipeline's own thread; returns after the last
// one. Before a frame goes in, `enter` is called with its index, from 0, on the caller's thread.
// `frames` are all BGR (CV_8UC3) or all I420 as cv::cvtColor makes it (CV_8UC1, 1.5 times the
// height, even width and height). Starts GStreamer where that is not done. Throws
// std::runtime_error where the pipeline cannot be built or fails, or `leave` throws; and what
// `enter` throws.
void PlayThroughPipeline(const std::vector<cv::Mat>& frames, double frame_rate_hz,
                         const PipelineSettings& settings,
                         const std::function<void(GstBuffer*)>& leave,
                         const std::function<void(std::size_t)>& enter = nullptr);

}  // namespace windhover::replay
