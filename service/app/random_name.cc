// SPDX-License-Identifier: Apache-2.0
#include "service/app/random_name.h"

#include <spdlog/fmt/fmt.h>

#include <random>

namespace windhover {

std::string RandomName() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

}  // namespace windhover
