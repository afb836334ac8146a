// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/publish_element.h"

#include <array>
#include <cinttypes>
#include <stdexcept>
#include <utility>

#include "gst-plugins/debug.h"
#include "service/gstreamer/detection_meta.h"
#include "service/gstreamer/homography_meta.h"

namespace windhover {
namespace {

struct CounterProperty {
  const char* name;
  const char* nick;
  const char* blurb;
  std::uint64_t Publisher::Counters::*member;
};

constexpr std::array<CounterProperty, 5> kCounters = {{
    {"published-homographies", "Published homographies",
     "Samples of the homography topic written since READY", &Publisher::Counters::homographies},
    {"published-detections", "Published detections",
     "Samples of the detections topic written since READY, one a frame, also without detections",
     &Publisher::Counters::detections},
    {"published-boxes", "Published boxes", "Detections inside the samples written since READY",
     &Publisher::Counters::boxes},
    {"failed-samples", "Failed samples",
     "Samples of either topic that could not be written since READY", &Publisher::Counters::failed},
    {"omitted-boxes", "Omitted boxes",
     "Detections left out since READY because one sample holds no more",
     &Publisher::Counters::omitted},
}};

}  // namespace

const ElementText PublishElement::kText = {
    "whpublish", "GstWindhoverPublish", "Aerial video DDS publisher",
    "Filter/Analyzer/Video/Network",
    "Sends the homography of whregister and the detections of whmotion over DDS, one sample of "
    "each "
    "topic for each frame, keyed by the stream's name, with the frame's own time stamp. Pictures "
    "pass "
    "unchanged, so it may stand anywhere behind whregister. Subscribers can find the stream from "
    "READY on; the element message 'windhover-subscribers' tells of them. Stays on the loopback "
    "interface unless CYCLONEDDS_URI says otherwise"};

void PublishElement::InstallProperties(GObjectClass* klass) {
  ElementWithOptions::InstallProperties(klass);
  guint id = kFirstOwnProperty;
  for (const CounterProperty& counter : kCounters) {
    g_object_class_install_property(
        klass, id++,
        g_param_spec_uint64(counter.name, counter.nick, counter.blurb, 0, G_MAXUINT64, 0,
                            static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
  }
  g_object_class_install_property(
      klass, id,
      g_param_spec_int("subscribers", "Subscribers",
                       "Subscribers that are matched to both topics now", 0, G_MAXINT, 0,
                       static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
  g_signal_new_class_handler("subscribers-in", G_TYPE_FROM_CLASS(klass),
                             static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION),
                             G_CALLBACK(&PublishElement::SubscribersIn), nullptr, nullptr, nullptr,
                             G_TYPE_INT, 1, G_TYPE_STRING);
}

gint PublishElement::SubscribersIn(GstElement* object, const gchar* partition) {
  auto& element = static_cast<PublishElement&>(*reinterpret_cast<ElementHost*>(object)->element);
  const std::scoped_lock lock(element.publisher_mutex_);
  if (element.publisher_ == nullptr) return 0;
  return element.publisher_->subscribers(partition != nullptr ? partition : "");
}

bool PublishElement::SetProperty(guint id, const GValue* value) {
  options_changed_ = true;
  return ElementWithOptions::SetProperty(id, value);
}

bool PublishElement::GetProperty(guint id, GValue* value) {
  if (id < kFirstOwnProperty) return ElementWithOptions::GetProperty(id, value);
  const std::scoped_lock lock(publisher_mutex_);
  const guint index = id - kFirstOwnProperty;
  if (index < kCounters.size()) {
    const Publisher::Counters counters =
        publisher_ != nullptr ? publisher_->counters() : last_counters_;
    g_value_set_uint64(value, counters.*kCounters[index].member);
    return true;
  }
  if (index > kCounters.size()) return false;
  g_value_set_int(value, publisher_ != nullptr ? publisher_->subscribers() : 0);
  return true;
}

void PublishElement::MakePublisher() {
  Close();
  GST_OBJECT_LOCK(host());
  options_changed_ = false;
  GST_OBJECT_UNLOCK(host());
  auto made = std::make_unique<Publisher>(Options<PublishOptions>(), [this](int subscribers) {
    GstStructure* structure =
        gst_structure_new("windhover-subscribers", "subscribers", G_TYPE_INT, subscribers, nullptr);
    gst_element_post_message(host(), gst_message_new_element(GST_OBJECT(host()), structure));
  });
  const std::scoped_lock lock(publisher_mutex_);
  publisher_ = std::move(made);
  failures_warned_of_ = 0;
}

void PublishElement::Open() { MakePublisher(); }

void PublishElement::Start() {
  GST_OBJECT_LOCK(host());
  const bool changed = options_changed_;
  GST_OBJECT_UNLOCK(host());
  // Null where the last attempt threw.
  if (changed || publisher_ == nullptr) MakePublisher();
}

void PublishElement::Stop() { End(); }

void PublishElement::Close() {
  std::unique_ptr<Publisher> old;
  {
    const std::scoped_lock lock(publisher_mutex_);
    if (publisher_ == nullptr) return;
    last_counters_ = publisher_->counters();
    old = std::move(publisher_);
  }
}

void PublishElement::End() {
  if (publisher_ != nullptr && !publisher_->End()) {
    GST_WARNING_OBJECT(host(),
                       "some subscribers may not have got the whole stream, or not its end");
  }
}

GstFlowReturn PublishElement::Process(BufferPtr buffer) {
  const auto* meta = gst_buffer_get_windhover_homography_meta(buffer.get());
  if (meta == nullptr) throw std::runtime_error("whpublish needs whregister before it");
  const int width = GST_VIDEO_INFO_WIDTH(&info_);
  const int height = GST_VIDEO_INFO_HEIGHT(&info_);
  const GstClockTime pts = GST_BUFFER_PTS(buffer.get());
  const std::int64_t pts_ns = GST_CLOCK_TIME_IS_VALID(pts) ? static_cast<std::int64_t>(pts) : -1;
  GetDetections(buffer.get(), width, height, detections_);
  const bool told_homography =
      publisher_->Publish(meta->registration, meta->width, meta->height, pts_ns);
  const bool told_detections =
      publisher_->Publish(meta->registration.frame_number, width, height, pts_ns, detections_);
  if (!told_homography || !told_detections) WarnOfFailures();
  return Push(std::move(buffer));
}

// At most once a second.
void PublishElement::WarnOfFailures() {
  const GstClockTime now = gst_util_get_timestamp();
  if (GST_CLOCK_TIME_IS_VALID(last_warning_) && now - last_warning_ < GST_SECOND) return;
  last_warning_ = now;
  const std::uint64_t failed = publisher_->counters().failed;
  GST_ELEMENT_WARNING(host(), RESOURCE, WRITE,
                      ("%" PRIu64 " samples could not be published", failed - failures_warned_of_),
                      ("a subscriber lags behind, or the bus cannot be used"));
  failures_warned_of_ = failed;
}

}  // namespace windhover
