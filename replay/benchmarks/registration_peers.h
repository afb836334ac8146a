// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "replay/baselines/registration_peer.h"

namespace windhover::replay {

struct RegistrationPeerKind {
  std::string name;   // as in the names of figures
  std::string title;  // for people
  bool slow;          // measured on every tenth pair only
  std::unique_ptr<RegistrationPeer> (*make)();
};

// All that registration is compared with.
const std::vector<RegistrationPeerKind>& RegistrationPeerKinds();

}  // namespace windhover::replay
