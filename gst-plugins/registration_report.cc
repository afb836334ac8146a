// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/registration_report.h"

#include <cinttypes>

#include "gst-plugins/debug.h"

namespace windhover {
namespace {

constexpr int kFramesASecond = 30;

const char* NameOf(RegistrationQuality quality) {
  switch (quality) {
    case RegistrationQuality::kValid:
      return "valid";
    case RegistrationQuality::kDegraded:
      return "degraded";
    case RegistrationQuality::kLost:
      return "lost";
  }
  return "unknown";
}

}  // namespace

std::optional<RegistrationReport::News> RegistrationReport::Observe(RegistrationQuality quality,
                                                                    GstClockTime pts) {
  const bool lost = quality == RegistrationQuality::kLost;
  ++frames_since_news_;
  if (lost != was_lost_) ++changes_;
  was_lost_ = lost;
  if (lost == told_lost_) return std::nullopt;

  const bool timed = GST_CLOCK_TIME_IS_VALID(pts) && GST_CLOCK_TIME_IS_VALID(last_news_);
  const bool second_has_passed = timed ? pts < last_news_ || pts - last_news_ >= GST_SECOND
                                       : frames_since_news_ >= kFramesASecond;
  if (ever_told_ && !second_has_passed) return std::nullopt;

  const News news{lost, changes_ - 1};
  ever_told_ = true;
  told_lost_ = lost;
  changes_ = 0;
  frames_since_news_ = 0;
  last_news_ = pts;
  return news;
}

void RegistrationReport::Reset() { *this = RegistrationReport(); }

void PostRegistrationNews(GstElement* element, const RegistrationReport::News& news,
                          const FrameRegistration& registration, GstClockTime pts) {
  if (news.lost) {
    GST_WARNING_OBJECT(
        element,
        "registration lost at frame %" PRIu64 " (%" GST_TIME_FORMAT "): %d of %d tiles agree",
        registration.frame_number, GST_TIME_ARGS(pts), registration.inliers, registration.tiles);
  } else {
    GST_INFO_OBJECT(element, "registration found again at frame %" PRIu64,
                    registration.frame_number);
  }
  GstStructure* structure = gst_structure_new(
      "windhover-registration", "quality", G_TYPE_STRING, NameOf(registration.quality),
      "frame-number", G_TYPE_UINT64, static_cast<guint64>(registration.frame_number), "pts",
      GST_TYPE_CLOCK_TIME, pts, "inliers", G_TYPE_INT, registration.inliers, "tiles", G_TYPE_INT,
      registration.tiles, "change", G_TYPE_STRING, NameOf(registration.change), "residual-px",
      G_TYPE_DOUBLE, registration.residual_px, "changes-kept-back", G_TYPE_INT,
      news.changes_kept_back, nullptr);
  gst_element_post_message(element, gst_message_new_element(GST_OBJECT(element), structure));
}

}  // namespace windhover
