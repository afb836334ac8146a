// SPDX-License-Identifier: Apache-2.0
#include "service/dds/subscriber.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "service/dds/conversion.h"
#include "service/dds/handles.h"
#include "service/dds/log.h"
#include "service/dds/participant.h"

namespace windhover {
namespace {

using EndReason = Subscriber::EndReason;

// Samples of one topic that one call of Poll hands over at most.
constexpr int kBatch = 16;

// Samples lent by the reader's cache until this goes out of scope.
class Loan {
 public:
  explicit Loan(dds_entity_t reader) : reader_(reader) {
    count_ = CheckDds(dds_take(reader, data_.data(), infos_.data(), kBatch, kBatch), "dds_take");
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
  ~Loan() {
    if (count_ > 0) dds_return_loan(reader_, data_.data(), count_);
  }

  int count() const { return count_; }
  const void* data(int i) const { return data_[i]; }
  const dds_sample_info_t& info(int i) const { return infos_[i]; }

 private:
  dds_entity_t reader_;
  int count_ = 0;
  std::array<void*, kBatch> data_{};
  std::array<dds_sample_info_t, kBatch> infos_{};
};

// Tells from the state that comes with each sample when streams end. The state is of the moment
// when the sample was taken, so an end is only reported once no sample is left.
class Endings {
 public:
  using End = std::function<void(const std::string& stream, EndReason reason)>;

  void See(const char* stream, const dds_sample_info_t& info, const End& end) {
    auto known = streams_.find(std::string_view(stream));
    if (known == streams_.end()) known = streams_.emplace(stream, Instance{}).first;
    Instance& instance = known->second;
    // The stream was over and started again between two samples. Each end leaves it without
    // writers; where it was not disposed as often, one of them was lost.
    const std::uint32_t disposed = info.disposed_generation_count - instance.times_disposed;
    const std::uint32_t abandoned = info.no_writers_generation_count - instance.times_abandoned;
    if (info.instance_handle == instance.handle && (disposed > 0 || abandoned > 0)) {
      end(known->first, abandoned > disposed ? EndReason::kLost : EndReason::kEnded);
    }
    instance = {info.instance_handle, info.disposed_generation_count,
                info.no_writers_generation_count, info.instance_state};
  }

  // No sample is left.
  void Report(const End& end) {
    for (auto known = streams_.begin(); known != streams_.end();) {
      if (known->second.state == DDS_IST_ALIVE) {
        ++known;
        continue;
      }
      const bool disposed = known->second.state == DDS_IST_NOT_ALIVE_DISPOSED;
      end(known->first, disposed ? EndReason::kEnded : EndReason::kLost);
      known = streams_.erase(known);
    }
  }

 private:
  struct Instance {
    dds_instance_handle_t handle = DDS_HANDLE_NIL;
    std::uint32_t times_disposed = 0;
    std::uint32_t times_abandoned = 0;
    dds_instance_state_t state = DDS_IST_ALIVE;
  };
  std::map<std::string, Instance, std::less<>> streams_;
};

// One topic, its reader and what is known of its streams.
class TopicReader {
 public:
  TopicReader(dds_entity_t participant, dds_entity_t waitset, const dds_topic_descriptor_t* type,
              const char* name, dds_qos_t* qos)
      : name_(name),
        topic_(dds_create_topic(participant, type, name, nullptr, nullptr), "dds_create_topic"),
        reader_(dds_create_reader(participant, topic_.get(), qos, nullptr), "dds_create_reader"),
        something_to_take_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE),
                           "dds_create_readcondition") {
    CheckDds(dds_set_status_mask(reader_.get(), DDS_SUBSCRIPTION_MATCHED_STATUS |
                                                    DDS_REQUESTED_INCOMPATIBLE_QOS_STATUS),
             "dds_set_status_mask");
    CheckDds(dds_waitset_attach(waitset, reader_.get(), 0), "dds_waitset_attach");
    CheckDds(dds_waitset_attach(waitset, something_to_take_.get(), 0), "dds_waitset_attach");
  }

  // The number of publishers now.
  int UpdatePublishers() {
    dds_requested_incompatible_qos_status_t incompatible;
    CheckDds(dds_get_requested_incompatible_qos_status(reader_.get(), &incompatible),
             "dds_get_requested_incompatible_qos_status");
    if (incompatible.total_count_change > 0 &&
        incompatible.last_policy_id != DDS_PARTITION_QOS_POLICY_ID) {
      Log()->warn("A publisher of {} offers less than is asked for (QoS policy {}): not matched",
                  name_, incompatible.last_policy_id);
    }
    dds_subscription_matched_status_t matched;
    CheckDds(dds_get_subscription_matched_status(reader_.get(), &matched),
             "dds_get_subscription_matched_status");
    return static_cast<int>(matched.current_count);
  }

  // Takes up to kBatch samples: calls stream_of(data) for each, then sample(data, info) for each
  // that has valid data and belongs to the stream. True where there may be more to take, or an end
  // to report.
  template <typename StreamOf, typename OnSample>
  bool Take(const std::string& stream, StreamOf stream_of, OnSample sample,
            const Endings::End& end) {
    const Loan loan(reader_.get());
    for (int i = 0; i < loan.count(); ++i) {
      const char* name = stream_of(loan.data(i));
      if (!stream.empty() && stream != name) continue;
      endings_.See(name, loan.info(i), end);
      if (loan.info(i).valid_data) sample(loan.data(i), loan.info(i));
    }
    if (loan.count() == kBatch) return true;
    endings_.Report(end);
    return false;
  }

 private:
  const char* name_;
  Endings endings_;
  Entity topic_;
  Entity reader_;
  Entity something_to_take_;
};

}  // namespace

struct Subscriber::State {
  explicit State(const SubscribeOptions& options)
      : stream(options.stream),
        participant(options.domain),
        waitset(dds_create_waitset(participant.get()), "dds_create_waitset"),
        interrupt(dds_create_guardcondition(participant.get()), "dds_create_guardcondition") {
    CheckDds(dds_waitset_attach(waitset.get(), interrupt.get(), 0), "dds_waitset_attach");
    const Qos qos = MakeQos(options.reliable, 0, options.history_depth, options.partition);
    if (options.homographies) {
      homographies.emplace(participant.get(), waitset.get(), HomographyDescriptor(),
                           kHomographyTopic, qos.get());
    }
    if (options.detections) {
      detections.emplace(participant.get(), waitset.get(), DetectionsDescriptor(), kDetectionsTopic,
                         qos.get());
    }
  }

  void TellPublishers(const Handlers& handlers) {
    std::optional<int> now;
    for (auto* reader : {&homographies, &detections}) {
      if (!reader->has_value()) continue;
      const int of_topic = (*reader)->UpdatePublishers();
      now = std::min(now.value_or(of_topic), of_topic);
    }
    const int before = std::exchange(publishers, now.value_or(0));
    if (publishers != before && handlers.publishers_changed) {
      handlers.publishers_changed(publishers);
    }
  }

  // `sample` is the object that is used again for each sample.
  template <typename Sample, typename StreamOf>
  bool Take(TopicReader& reader, Topic topic, StreamOf stream_of, Sample& sample,
            const std::function<void(const Sample&)>& handler, const Handlers& handlers) {
    return reader.Take(
        stream, stream_of,
        [&](const void* data, const dds_sample_info_t& info) {
          if (!handler) return;
          Read(data, sample);
          sample.written_ns = info.source_timestamp;
          handler(sample);
        },
        [&](const std::string& name, EndReason reason) {
          if (handlers.end) handlers.end(name, topic, reason);
        });
  }

  std::string stream;
  int publishers = 0;
  bool more = false;  // may be there, so the next Poll must not wait
  HomographySample homography_sample;
  DetectionsSample detections_sample;
  Participant participant;
  Entity waitset;
  Entity interrupt;
  std::optional<TopicReader> homographies;
  std::optional<TopicReader> detections;
};

Subscriber::Subscriber(const SubscribeOptions& options)
    : state_(std::make_unique<State>(options)) {}

Subscriber::~Subscriber() = default;

bool Subscriber::Poll(std::chrono::nanoseconds longest, const Handlers& handlers) {
  State& state = *state_;
  const bool more = state.more;
  const dds_duration_t wait = more ? 0 : longest.count() < 0 ? DDS_INFINITY : longest.count();
  const int triggered =
      CheckDds(dds_waitset_wait(state.waitset.get(), nullptr, 0, wait), "dds_waitset_wait");
  bool interrupted = false;
  CheckDds(dds_take_guardcondition(state.interrupt.get(), &interrupted), "dds_take_guardcondition");
  if (interrupted || (triggered == 0 && !more)) return false;
  state.TellPublishers(handlers);
  bool still_more = false;
  if (state.homographies) {
    still_more = state.Take(*state.homographies, Topic::kHomography, HomographyStream,
                            state.homography_sample, handlers.homography, handlers);
  }
  if (state.detections) {
    still_more |= state.Take(*state.detections, Topic::kDetections, DetectionsStream,
                             state.detections_sample, handlers.detections, handlers);
  }
  state.more = still_more;
  return true;
}

void Subscriber::Interrupt() { dds_set_guardcondition(state_->interrupt.get(), true); }

}  // namespace windhover
