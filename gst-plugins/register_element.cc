// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/register_element.h"

#include <utility>

#include "gst-plugins/luma.h"
#include "gst-plugins/progressive.h"
#include "gst-plugins/video_frame_map.h"
#include "service/gstreamer/homography_meta.h"

namespace windhover {

const ElementText RegisterElement::kText = {
    "whregister", "GstWindhoverRegister", "Aerial video registration", "Filter/Analyzer/Video",
    "Measures how each frame of a moving camera lies over the ground, by tiled phase correlation, "
    "and attaches the homographies to the previous frame and, in anchor mode, to a keyframe, with "
    "covariance, inliers and quality, as GstWindhoverHomographyMeta. Pictures pass unchanged. "
    "Posts the element message 'windhover-registration' when registration is lost or found again. "
    "Stands first: whregister ! whbackground ! whmotion ! whpublish ! whoverlay"};

void RegisterElement::Start() {
  options_ = Options<RegistrationOptions>();
  backend_ = shared_.Acquire(Options<DeviceOptions>().device);
  frames_before_ = 0;
  frames_ = 0;
}

void RegisterElement::Stop() {
  registration_.reset();
  luma_ = {};
  gray_ = {};
  backend_.reset();
  report_.Reset();
}

void RegisterElement::Configure(const GstVideoInfo& info) {
  RequireProgressive(info);
  info_ = info;
  const int width = GST_VIDEO_INFO_WIDTH(&info);
  const int height = GST_VIDEO_INFO_HEIGHT(&info);
  if (registration_ != nullptr && gray_.width() == width && gray_.height() == height) return;
  registration_.reset();
  luma_.Reset();
  registration_ = std::make_unique<StreamRegistration>(backend_, width, height, options_);
  gray_ = backend_->MakeImage<std::uint8_t>(width, height);
  frames_before_ = frames_;
}

GstFlowReturn RegisterElement::Process(BufferPtr buffer) {
  RequireProgressive(info_, buffer.get());
  {
    const VideoFrameMap map(info_, buffer.get(), GST_MAP_READ);
    if (luma_.Extract(map.frame(), gray_)) registration_->Reset();
  }
  FrameRegistration registration = registration_->Register(gray_);
  registration.frame_number += frames_before_;
  registration.anchor_number += frames_before_;
  frames_ = registration.frame_number + 1;

  const GstClockTime pts = GST_BUFFER_PTS(buffer.get());
  if (const auto news = report_.Observe(registration.quality, pts)) {
    PostRegistrationNews(host(), *news, registration, pts);
  }

  buffer = MakeWritable(std::move(buffer));
  // That of another whregister before this one.
  if (auto* old = gst_buffer_get_windhover_homography_meta(buffer.get())) {
    gst_buffer_remove_meta(buffer.get(), &old->meta);
  }
  gst_buffer_add_windhover_homography_meta(buffer.get(), registration, gray_.width(),
                                           gray_.height());
  return Push(std::move(buffer));
}

void RegisterElement::Reset() {
  luma_.Reset();
  if (registration_ != nullptr) registration_->Reset();
}

}  // namespace windhover
