// SPDX-License-Identifier: Apache-2.0
#include "service/dds/publisher.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/dds/conversion.h"
#include "service/dds/handles.h"
#include "service/dds/log.h"
#include "service/dds/participant.h"

namespace windhover {
namespace {

using Count = std::atomic<std::uint64_t>;

// How many subscribers each topic has.
struct Matches {
  explicit Matches(Publisher::SubscribersChanged changed) : changed(std::move(changed)) {}

  int both() const { return std::min(homography.load(), detections.load()); }

  std::atomic<int> homography = 0;
  std::atomic<int> detections = 0;
  Publisher::SubscribersChanged changed;
};

// Whether the partitions of `qos` include this one by name.
bool HasPartition(const dds_qos_t* qos, const std::string& partition) {
  std::uint32_t count = 0;
  char** names = nullptr;
  dds_qget_partition(qos, &count, &names);
  bool found = count == 0 && partition.empty();
  for (std::uint32_t i = 0; i < count; ++i) {
    found = found || partition == names[i];
    dds_free(names[i]);
  }
  dds_free(names);
  return found;
}

// One topic and its writer. `subscribers` is the topic's number in `matches`.
class TopicWriter {
 public:
  TopicWriter(dds_entity_t participant, const dds_topic_descriptor_t* type, const char* name,
              dds_qos_t* qos, const Matches& matches, std::atomic<int>& subscribers)
      : name_(name),
        matches_(matches),
        subscribers_(subscribers),
        topic_(dds_create_topic(participant, type, name, nullptr, nullptr), "dds_create_topic") {
    const Listener listener(dds_create_listener(this));
    dds_lset_publication_matched(listener.get(), &TopicWriter::OnMatched);
    dds_lset_offered_incompatible_qos(listener.get(), &TopicWriter::OnIncompatible);
    writer_ = Entity(dds_create_writer(participant, topic_.get(), qos, listener.get()),
                     "dds_create_writer");
  }

  bool Write(const void* message) { return Report(dds_write(writer_.get(), message), "dds_write"); }

  bool Dispose(const void* message) {
    return Report(dds_dispose(writer_.get(), message), "dds_dispose") &&
           Report(dds_unregister_instance(writer_.get(), message), "dds_unregister_instance");
  }

  bool WaitForAcknowledgement(dds_duration_t longest) {
    return dds_wait_for_acks(writer_.get(), longest) == DDS_RETCODE_OK;
  }

  int SubscribersIn(const std::string& partition) const {
    std::vector<dds_instance_handle_t> readers(static_cast<std::size_t>(subscribers_.load()));
    if (dds_get_matched_subscriptions(writer_.get(), readers.data(), readers.size()) < 0) return 0;
    return static_cast<int>(std::count_if(readers.begin(), readers.end(), [&](auto reader) {
      // Null where it has gone since.
      dds_builtintopic_endpoint_t* endpoint =
          dds_get_matched_subscription_data(writer_.get(), reader);
      if (endpoint == nullptr) return false;
      const bool found = HasPartition(endpoint->qos, partition);
      dds_builtintopic_free_endpoint(endpoint);
      return found;
    }));
  }

 private:
  static void OnMatched(dds_entity_t, const dds_publication_matched_status_t status, void* self) {
    auto& writer = *static_cast<TopicWriter*>(self);
    writer.subscribers_ = static_cast<int>(status.current_count);
    if (writer.matches_.changed) writer.matches_.changed(writer.matches_.both());
  }

  static void OnIncompatible(dds_entity_t, const dds_offered_incompatible_qos_status_t status,
                             void* self) {
    if (status.last_policy_id == DDS_PARTITION_QOS_POLICY_ID) return;
    Log()->warn("A subscriber of {} wants more than is offered (QoS policy {}): not matched",
                static_cast<TopicWriter*>(self)->name_, status.last_policy_id);
  }

  // Logs each failure whose count is a power of two.
  bool Report(dds_return_t result, const char* call) {
    if (result >= 0) return true;
    if (std::has_single_bit(++failures_)) {
      Log()->warn("{} of {} failed ({} so far): {}", call, name_, failures_,
                  dds_strretcode(result));
    }
    return false;
  }

  const char* name_;
  const Matches& matches_;
  std::atomic<int>& subscribers_;
  std::uint64_t failures_ = 0;
  Entity topic_;
  Entity writer_;
};

Qos HomographyQos(const PublishOptions& options) {
  return MakeQos(options.reliable, options.max_blocking_ms, options.history_depth,
                 options.partition);
}

Qos DetectionsQos(const PublishOptions& options) {
  Qos qos = HomographyQos(options);
  if (options.detections_lifespan_ms > 0) {
    dds_qset_lifespan(qos.get(), DDS_MSECS(options.detections_lifespan_ms));
  }
  return qos;
}

const PublishOptions& Checked(const PublishOptions& options) {
  CheckOptions(options);
  const std::string& stream = options.stream;
  if (stream.empty() || stream.size() > kMaxStreamName || stream.find('\0') != std::string::npos) {
    throw OptionError("stream '" + stream + "' is not a name of 1 to " +
                      std::to_string(kMaxStreamName) + " bytes");
  }
  return options;
}

}  // namespace

static_assert(Publisher::kMaxDetections == DetectionsMessage::kCapacity);

struct Publisher::State {
  State(const PublishOptions& options, SubscribersChanged subscribers_changed)
      : max_blocking(DDS_MSECS(Checked(options).max_blocking_ms)),
        matches(std::move(subscribers_changed)),
        participant(options.domain),
        homography_message(options.stream),
        detections_message(options.stream),
        homography(participant.get(), HomographyDescriptor(), kHomographyTopic,
                   HomographyQos(options).get(), matches, matches.homography),
        detections(participant.get(), DetectionsDescriptor(), kDetectionsTopic,
                   DetectionsQos(options).get(), matches, matches.detections) {}

  bool Done(bool written, Count& count) {
    ended.reset();
    ++(written ? count : failed);
    return written;
  }

  // After the first failure the rest would most likely wait in vain, too.
  bool End() {
    if (!homography.Dispose(homography_message.data()) ||
        !detections.Dispose(detections_message.data())) {
      return false;
    }
    const dds_time_t until = dds_time() + max_blocking;
    return homography.WaitForAcknowledgement(max_blocking) &&
           detections.WaitForAcknowledgement(std::max<dds_duration_t>(until - dds_time(), 0));
  }

  dds_duration_t max_blocking;
  // What End() has returned; nothing while the stream goes on.
  std::optional<bool> ended;
  Count homographies = 0;
  Count samples_of_detections = 0;
  Count boxes = 0;
  Count failed = 0;
  Count omitted = 0;
  Matches matches;
  Participant participant;
  HomographyMessage homography_message;
  DetectionsMessage detections_message;
  TopicWriter homography;
  TopicWriter detections;
};

Publisher::Publisher(const PublishOptions& options, SubscribersChanged subscribers_changed)
    : state_(std::make_unique<State>(options, std::move(subscribers_changed))) {}

Publisher::~Publisher() { End(); }

bool Publisher::Publish(const FrameRegistration& registration, int width, int height,
                        std::int64_t pts_ns) {
  state_->homography_message.Set(registration, width, height, pts_ns);
  return state_->Done(state_->homography.Write(state_->homography_message.data()),
                      state_->homographies);
}

bool Publisher::Publish(std::uint64_t frame_number, int width, int height, std::int64_t pts_ns,
                        const std::vector<Detection>& detections) {
  const std::size_t omitted =
      state_->detections_message.Set(frame_number, width, height, pts_ns, detections);
  const bool written = state_->Done(state_->detections.Write(state_->detections_message.data()),
                                    state_->samples_of_detections);
  if (written) {
    state_->boxes += detections.size() - omitted;
    state_->omitted += omitted;
  }
  return written;
}

bool Publisher::End() {
  if (!state_->ended) state_->ended = state_->End();
  return *state_->ended;
}

Publisher::Counters Publisher::counters() const {
  Counters counters;
  counters.homographies = state_->homographies;
  counters.detections = state_->samples_of_detections;
  counters.boxes = state_->boxes;
  counters.failed = state_->failed;
  counters.omitted = state_->omitted;
  return counters;
}

int Publisher::subscribers() const { return state_->matches.both(); }

int Publisher::subscribers(const std::string& partition) const {
  return std::min(state_->homography.SubscribersIn(partition),
                  state_->detections.SubscribersIn(partition));
}

}  // namespace windhover
