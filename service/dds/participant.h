// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "service/dds/handles.h"

namespace windhover {

// A participant in a DDS domain. Several of one process share the domain's configuration:
//
// - CYCLONEDDS_URI set: Cyclone DDS reads it; all that it says holds.
// - unset or empty: everything stays on this machine (interface lo, no multicast, peer localhost,
//   automatic participant index up to 100), and one log line says how to open it to a network.
// - a domain that other code of the process has configured before stays as it is.
//
// May be made and destroyed by any thread.
class Participant {
 public:
  // `domain` is 0 to 230. Throws DdsError with what Cyclone DDS says, e.g. about CYCLONEDDS_URI.
  explicit Participant(int domain);
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;
  ~Participant();

  dds_entity_t get() const { return participant_.get(); }

 private:
  class Domain;
  std::shared_ptr<Domain> domain_;
  Entity participant_;
};

}  // namespace windhover
