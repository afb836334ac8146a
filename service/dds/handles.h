// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>
#include <utility>

#include "service/dds/dds_error.h"

namespace windhover {

// Gives back what the C API returned; throws DdsError with `call` and the reason where that is an
// error.
template <typename T>
T CheckDds(T result, const char* call) {
  if (result < 0) {
    throw DdsError(std::string(call) + ": " + dds_strretcode(static_cast<dds_return_t>(result)));
  }
  return result;
}

// Owns an entity of the C API; deleting it deletes its children.
class Entity {
 public:
  Entity() = default;
  // Throws DdsError where `handle` is an error code, as the C API's constructors return it.
  Entity(dds_entity_t handle, const char* call) : handle_(CheckDds(handle, call)) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }

  dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

struct ListenerDeleter {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using Listener = std::unique_ptr<dds_listener_t, ListenerDeleter>;

// Reliability, history and partitions of a writer or reader. `history_depth` 0 keeps all;
// `partitions` are separated by commas, and an empty name is the default partition.
Qos MakeQos(bool reliable, int max_blocking_ms, int history_depth, const std::string& partitions);

}  // namespace windhover
