// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/opencl/api.h"

namespace windhover::opencl {

struct Device {
  cl_platform_id platform = nullptr;
  cl_device_id id = nullptr;
  DeviceInfo info;
};

// All devices in the order of preference: GPUs, CPUs, others; among those as the platforms list
// them. Empty where no platform is installed; a platform that fails is left out.
std::vector<Device> ListDevices();

// Index of the device that `selector` names, in the grammar of Backend::Create; nothing where none
// fits. Upper and lower case do not matter. "ACCELERATOR" is a type, too.
std::optional<std::size_t> SelectDevice(const std::vector<DeviceInfo>& devices,
                                        const std::string& selector);

// "GPU", "CPU" or "ACCELERATOR".
std::string TypeName(DeviceKind kind);

// The text by which SelectDevice finds devices[index]: with its name, or with its index where the
// name leads to another device.
std::string SelectorOf(const std::vector<DeviceInfo>& devices, std::size_t index);

// What clGetDeviceInfo says, where that is a text.
std::string DeviceText(cl_device_id device, cl_device_info what);

}  // namespace windhover::opencl
