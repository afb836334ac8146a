// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/backend.h"

#include <cstdlib>

#include "gpu-kernels/cpu/cpu_backend.h"

namespace windhover {
namespace {

const char* TypeName(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::kOpenClGpu:
      return "GPU";
    case DeviceKind::kOpenClCpu:
      return "CPU";
    default:
      return "";
  }
}

}  // namespace

std::string DeviceInfo::Describe() const {
  if (kind == DeviceKind::kCpuTwin) return "CPU twin";
  const std::string type = TypeName(kind);
  return "OpenCL " + (type.empty() ? "" : type + " ") + "'" + name + "' (" + platform + ")";
}

std::string DeviceInfo::Selector() const {
  if (kind == DeviceKind::kCpuTwin) return "cpu";
  return platform + ":" + TypeName(kind) + ":" + name;
}

std::shared_ptr<Backend> Backend::Create(const std::string&, const Warn&) {
  return MakeCpuBackend();
}

std::vector<DeviceInfo> Backend::Devices() { return {CpuTwinInfo()}; }

}  // namespace windhover
