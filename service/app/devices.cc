// SPDX-License-Identifier: Apache-2.0
#include "service/app/devices.h"

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "gpu-kernels/backend.h"
#include "service/app/exit_code.h"
#include "service/dds/log.h"

namespace windhover {
namespace {

std::shared_ptr<Backend> MakeBackend(const std::string& device) {
  return Backend::Create(device, [](const std::string& text) { Log()->warn("{}", text); });
}

std::string Reason(const std::string& device, const DeviceInfo& used) {
  if (!device.empty()) return "asked for as '" + device + "'";
  const char* variable = std::getenv("WINDHOVER_DEVICE");
  if (variable != nullptr && *variable != '\0') {
    return "WINDHOVER_DEVICE is '" + std::string(variable) + "'";
  }
  switch (used.kind) {
    case DeviceKind::kOpenClGpu:
      return "the first OpenCL GPU";
    case DeviceKind::kOpenClCpu:
      return "no OpenCL GPU; the first OpenCL CPU";
    case DeviceKind::kOpenClOther:
      return "no OpenCL GPU or CPU";
    case DeviceKind::kCpuTwin:
      break;
  }
  return "no OpenCL device";
}

}  // namespace

int ListDevices(const std::string& device) {
  const DeviceInfo used = MakeBackend(device)->device();
  bool marked = false;
  for (const DeviceInfo& info : Backend::Devices()) {
    const bool is_used = !marked && info.selector == used.selector;
    marked = marked || is_used;
    fmt::print("{} {}\n    --device '{}'", is_used ? "*" : " ", info.Describe(), info.selector);
    if (!info.version.empty()) fmt::print(", {}", info.version);
    if (info.compute_units > 0) fmt::print(", {} compute units", info.compute_units);
    fmt::print("\n");
  }
  fmt::print("* is used: {}\n", Reason(device, used));
  return kExitOk;
}

int WarmUpDevice(const std::string& device) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const std::shared_ptr<Backend> backend = MakeBackend(device);
  int kernels = 0;
  backend->WarmUp([&](const std::string& kernel) {
    ++kernels;
    fmt::print("{:7.1f} s  {}\n", seconds(), kernel);
    std::fflush(stdout);
  });
  fmt::print("{:7.1f} s  {} kernels ready on {}\n", seconds(), kernels,
             backend->device().Describe());
  return kExitOk;
}

}  // namespace windhover
