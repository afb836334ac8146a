// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace windhover {

// The bus cannot be used. The text names the call that failed and the reason.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace windhover
