// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/backend.h"

#include <cstdlib>
#include <optional>

#include "gpu-kernels/cpu/cpu_backend.h"
#include "gpu-kernels/opencl/device.h"
#include "gpu-kernels/opencl/opencl_backend.h"
#include "gpu-kernels/opencl/program_cache.h"

namespace windhover {
namespace {

std::string SelectorFromEnvironment() {
  const char* value = std::getenv("WINDHOVER_DEVICE");
  return value == nullptr ? "" : value;
}

[[noreturn]] void RefuseDevice(const std::string& selector,
                               const std::vector<DeviceInfo>& open_cl_devices) {
  std::string text = "no device fits '" + selector + "'; there are:\n";
  for (const DeviceInfo& device : open_cl_devices) {
    text += "  " + device.selector + "\n";
  }
  throw DeviceError(text + "  cpu");
}

}  // namespace

std::string DeviceInfo::Describe() const {
  if (kind == DeviceKind::kCpuTwin) return "CPU twin";
  return "OpenCL " + opencl::TypeName(kind) + " '" + name + "' (" + platform + ")";
}

std::shared_ptr<Backend> Backend::Create(const std::string& device, const Warn& warn,
                                         const StageObserver& observe) {
  const std::string selector = device.empty() ? SelectorFromEnvironment() : device;
  if (selector == "cpu") return MakeCpuBackend();

  const std::vector<opencl::Device> devices = opencl::ListDevices();
  if (selector.empty() && devices.empty()) {
    if (warn) {
      warn(
          "no OpenCL device found: running on the CPU twin (install a driver, for example "
          "pocl-opencl-icd, or choose the device 'cpu' to say that this is meant)");
    }
    return MakeCpuBackend();
  }
  std::vector<DeviceInfo> infos;
  for (const opencl::Device& candidate : devices) infos.push_back(candidate.info);
  // The list is in the order of preference: an empty selector takes its first.
  const std::optional<std::size_t> chosen = opencl::SelectDevice(infos, selector);
  if (!chosen) RefuseDevice(selector, infos);
  return opencl::MakeOpenClBackend(
      devices[*chosen], opencl::ProgramCache(opencl::ProgramCache::DefaultFolder()), observe);
}

std::vector<DeviceInfo> Backend::Devices() {
  std::vector<DeviceInfo> infos;
  for (const opencl::Device& device : opencl::ListDevices()) infos.push_back(device.info);
  infos.push_back(CpuTwinInfo());
  return infos;
}

}  // namespace windhover
