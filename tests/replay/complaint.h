// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "replay/format/format_error.h"

namespace windhover::replay {

// The text of the FormatError that `action` throws.
template <typename Action>
std::string Complaint(Action&& action) {
  try {
    action();
  } catch (const FormatError& error) {
    return error.what();
  }
  return "(nothing thrown)";
}

}  // namespace windhover::replay
