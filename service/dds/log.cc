// SPDX-License-Identifier: Apache-2.0
#include "service/dds/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <mutex>

namespace windhover {

std::shared_ptr<spdlog::logger> Log() {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (auto logger = spdlog::get("windhover")) return logger;
  return spdlog::stderr_color_mt("windhover");
}

}  // namespace windhover
