// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "gst-plugins/element.h"
#include "service/dds/publisher.h"
#include "service/options/publish_options.h"

namespace windhover {

// whpublish: sends each frame's homography and detections to the bus (service/dds/publisher.h) and
// passes the frame on unchanged. Subscribers can find the stream from READY on; it ends for them at
// end of stream, or when the element leaves PAUSED.
//
// Each time the number of subscribers changes it posts the element message "windhover-subscribers"
// with the field subscribers (int). The action signal "subscribers-in" takes a partition's name and
// returns how many of them name that partition (int).
class PublishElement : public ElementWithOptions<PublishOptions> {
 public:
  static const ElementText kText;
  // And the action signal.
  static void InstallProperties(GObjectClass* klass);

  using ElementWithOptions::ElementWithOptions;

  void Open() override;
  void Start() override;
  void Stop() override;
  void Close() override;
  void Configure(const GstVideoInfo& info) override { info_ = info; }
  GstFlowReturn Process(BufferPtr buffer) override;
  void End() override;
  bool SetProperty(guint id, const GValue* value) override;
  bool GetProperty(guint id, GValue* value) override;

 private:
  static gint SubscribersIn(GstElement* object, const gchar* partition);
  void MakePublisher();
  void WarnOfFailures();

  GstVideoInfo info_;
  std::vector<Detection> detections_;
  GstClockTime last_warning_ = GST_CLOCK_TIME_NONE;
  std::uint64_t failures_warned_of_ = 0;
  // Properties have changed since the publisher was made; with the object's lock.
  bool options_changed_ = false;

  // Guards what follows against readers of the counters.
  std::mutex publisher_mutex_;
  std::unique_ptr<Publisher> publisher_;
  Publisher::Counters last_counters_;  // of the publisher before, once it is gone
};

}  // namespace windhover
