// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/stabilize_element.h"

#include <stdexcept>
#include <utility>

#include "gst-plugins/plane_warp.h"
#include "gst-plugins/screen_metadata.h"
#include "gst-plugins/video_frame_map.h"
#include "service/gstreamer/homography_meta.h"

namespace windhover {
namespace {

constexpr double kAssumedFrameRateHz = 25.0;

double FrameRateOf(const GstVideoInfo& info) {
  if (GST_VIDEO_INFO_FPS_N(&info) <= 0) return kAssumedFrameRateHz;
  return static_cast<double>(GST_VIDEO_INFO_FPS_N(&info)) / GST_VIDEO_INFO_FPS_D(&info);
}

// A running pool of frames laid out as the caps alone say.
ObjectPtr<GstBufferPool> MakePool(const GstVideoInfo& info) {
  ObjectPtr<GstBufferPool> pool(gst_video_buffer_pool_new());
  GstCaps* caps = gst_video_info_to_caps(&info);
  GstStructure* config = gst_buffer_pool_get_config(pool.get());
  gst_buffer_pool_config_set_params(config, caps, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)), 0,
                                    0);
  gst_caps_unref(caps);
  if (!gst_buffer_pool_set_config(pool.get(), config) ||
      !gst_buffer_pool_set_active(pool.get(), TRUE)) {
    throw std::runtime_error("no buffers for the stabilised pictures");
  }
  return pool;
}

void StopPool(ObjectPtr<GstBufferPool>& pool) {
  if (pool != nullptr) gst_buffer_pool_set_active(pool.get(), FALSE);
  pool.reset();
}

}  // namespace

const ElementText StabilizeElement::kText = {
    "whstabilize", "GstWindhoverStabilize", "Aerial video stabilisation", "Filter/Effect/Video",
    "Holds the picture of a moving camera still, by the homographies of whregister, which stands "
    "before it: either the ground keeps its place on the screen (mode=anchor), or the camera's way "
    "is followed with its shaking smoothed out (mode=smooth, which holds back "
    "'smoothing-lookahead' frames and says so in its latency). Homographies and regions of "
    "interest follow the picture"};

void StabilizeElement::Stop() {
  held_.Clear(source_pad());
  stabilisation_.reset();
  mosaic_ = {};
  StopPool(pool_);
  latency_.Stop();
}

void StabilizeElement::Configure(const GstVideoInfo& info) {
  info_ = info;
  mosaic_.Reset();
  stabilisation_.emplace(GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info), options_,
                         FrameRateOf(info));
  latency_.Configure(info, stabilisation_->lookahead());
  StopPool(pool_);
  pool_ = MakePool(info);
}

GstFlowReturn StabilizeElement::Process(BufferPtr buffer) {
  const auto* meta = gst_buffer_get_windhover_homography_meta(buffer.get());
  if (meta == nullptr || meta->width != GST_VIDEO_INFO_WIDTH(&info_) ||
      meta->height != GST_VIDEO_INFO_HEIGHT(&info_)) {
    throw std::runtime_error("whstabilize needs whregister before it, at the same frame size");
  }
  stabilisation_->Push(meta->registration);
  latency_.FrameIn(buffer.get());
  held_.AddFrame(std::move(buffer));
  return SendKnown();
}

GstFlowReturn StabilizeElement::SendKnown() {
  while (const auto pose = stabilisation_->Pop()) {
    const BufferPtr frame = held_.TakeFrame();
    if (frame == nullptr) throw std::logic_error("a pose for a frame that is not held");
    latency_.FrameOut(frame.get());
    const GstFlowReturn result = Push(Show(frame.get(), *pose));
    if (result != GST_FLOW_OK) {
      Reset();
      return result;
    }
    while (GstEvent* event = held_.TakeEvent()) PushEvent(event);
  }
  return GST_FLOW_OK;
}

BufferPtr StabilizeElement::Show(GstBuffer* frame, const ScreenPose& pose) {
  GstBuffer* acquired = nullptr;
  if (gst_buffer_pool_acquire_buffer(pool_.get(), &acquired, nullptr) != GST_FLOW_OK) {
    throw std::runtime_error("no buffer for a stabilised picture");
  }
  BufferPtr shown(acquired);
  {
    const VideoFrameMap from(info_, frame, GST_MAP_READ);
    const VideoFrameMap to(info_, shown.get(), GST_MAP_WRITE);
    PicturePlanes screen(to.frame());
    Draw(PicturePlanes(from.frame()), pose, screen);
  }
  gst_buffer_copy_into(
      shown.get(), frame,
      static_cast<GstBufferCopyFlags>(GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS), 0,
      static_cast<gsize>(-1));
  CarryMetadata(frame, pose, GST_VIDEO_INFO_WIDTH(&info_), GST_VIDEO_INFO_HEIGHT(&info_),
                shown.get());
  return shown;
}

void StabilizeElement::Draw(const PicturePlanes& frame, const ScreenPose& pose,
                            PicturePlanes& screen) {
  if (options_.border == BorderMode::kMosaic) {
    mosaic_.Show(frame, pose, screen);
    return;
  }
  const Outside outside =
      options_.border == BorderMode::kReplicate ? Outside::kReplicate : Outside::kFill;
  for (std::size_t i = 0; i < screen.size(); ++i) {
    WarpPlane(frame[i].pixels, InPlane(pose.screen_from_frame, screen[i].step), outside,
              screen[i].black, screen[i].pixels);
  }
}

bool StabilizeElement::Forward(GstEvent* event) {
  if (held_.empty()) return PushEvent(event);
  held_.AddEvent(event);
  return true;
}

GstFlowReturn StabilizeElement::Drain() {
  if (!stabilisation_) return GST_FLOW_OK;
  stabilisation_->Drain();
  return SendKnown();
}

void StabilizeElement::Reset() {
  held_.Clear(source_pad());
  mosaic_.Reset();
  if (stabilisation_) stabilisation_->Reset();
  latency_.Interrupt();
}

}  // namespace windhover
