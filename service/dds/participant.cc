// SPDX-License-Identifier: Apache-2.0
#include "service/dds/participant.h"

#include <dds/ddsrt/log.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "service/dds/log.h"

namespace windhover {
namespace {

constexpr const char* kLoopbackOnly =
    "<CycloneDDS><Domain Id=\"any\">"
    "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>100</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"localhost\"/></Peers></Discovery>"
    "</Domain></CycloneDDS>";

// What Cyclone DDS logs while this lives. It starts and stops domains under one lock of ours, so
// there is one at a time.
class CapturedLog {
 public:
  CapturedLog() { dds_set_log_sink(&CapturedLog::Append, this); }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;
  ~CapturedLog() { dds_set_log_sink(nullptr, nullptr); }

  // One line, without the library's own prefixes.
  std::string text() const {
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  static void Append(void* self, const dds_log_data_t* line) noexcept {
    auto& log = *static_cast<CapturedLog*>(self);
    std::string message(line->message, line->size);
    while (!message.empty() && (message.back() == '\n' || message.back() == ' ')) {
      message.pop_back();
    }
    const std::lock_guard lock(log.mutex_);
    if (!log.text_.empty()) log.text_ += "; ";
    log.text_ += message;
  }

  mutable std::mutex mutex_;
  std::string text_;
};

// Guards the making and ending of domains.
std::mutex& DomainMutex() {
  static std::mutex mutex;
  return mutex;
}

const char* UserConfiguration() {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  return uri != nullptr && *uri != '\0' ? uri : nullptr;
}

[[noreturn]] void Refuse(int domain, dds_return_t code, const std::string& log) {
  std::string text = "DDS domain " + std::to_string(domain) + " cannot be used";
  if (const char* uri = UserConfiguration())
    text += " with CYCLONEDDS_URI='" + std::string(uri) + "'";
  throw DdsError(text + ": " + (log.empty() ? dds_strretcode(code) : log));
}

}  // namespace

// The configuration of a domain that stays on loopback, as long as a participant of ours needs it.
// Made and destroyed under DomainMutex().
class Participant::Domain {
 public:
  static std::shared_ptr<Domain> Get(int id) {
    static std::map<int, std::weak_ptr<Domain>> domains;
    std::weak_ptr<Domain>& known = domains[id];
    if (auto domain = known.lock()) return domain;
    auto domain = std::make_shared<Domain>(id);
    known = domain;
    return domain;
  }

  explicit Domain(int id) : id_(id) {
    if (UserConfiguration() != nullptr) return;
    const CapturedLog log;
    handle_ = dds_create_domain(static_cast<dds_domainid_t>(id), kLoopbackOnly);
    if (handle_ == DDS_RETCODE_PRECONDITION_NOT_MET) return;
    if (handle_ < 0) Refuse(id, handle_, log.text());
    static std::set<int> told;
    if (!told.insert(id).second) return;
    Log()->info(
        "DDS domain {} stays on this machine. To open it to a network, set CYCLONEDDS_URI, e.g. to "
        "'<General><Interfaces><NetworkInterface name=\"eth0\"/></Interfaces></General>'",
        id);
  }
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;
  ~Domain() {
    // Deleting a domain deletes all its participants, also those of other code in the process.
    // Where there are such, it stays until the process ends.
    if (handle_ > 0 && dds_lookup_participant(static_cast<dds_domainid_t>(id_), nullptr, 0) == 0) {
      dds_delete(handle_);
    }
  }

 private:
  int id_;
  dds_entity_t handle_ = 0;
};

Participant::Participant(int domain) {
  const std::lock_guard lock(DomainMutex());
  // Where this throws, it goes under the lock, too.
  std::shared_ptr<Domain> configured = Domain::Get(domain);
  const CapturedLog log;
  const dds_entity_t handle =
      dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr);
  if (handle < 0) Refuse(domain, handle, log.text());
  participant_ = Entity(handle, "dds_create_participant");
  domain_ = std::move(configured);
}

Participant::~Participant() {
  const std::lock_guard lock(DomainMutex());
  participant_ = Entity();
  domain_.reset();
}

}  // namespace windhover
