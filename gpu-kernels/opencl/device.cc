// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/device.h"

#include <algorithm>
#include <cctype>

namespace windhover::opencl {
namespace {

std::string PlatformText(cl_platform_id platform, cl_platform_info what) {
  std::size_t size = 0;
  if (clGetPlatformInfo(platform, what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return "";
  std::string text(size, '\0');
  if (clGetPlatformInfo(platform, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
  text.resize(size - 1);
  return text;
}

DeviceInfo Describe(cl_platform_id platform, cl_device_id device) {
  DeviceInfo info;
  cl_device_type type = 0;
  clGetDeviceInfo(device, CL_DEVICE_TYPE, sizeof(type), &type, nullptr);
  info.kind = (type & CL_DEVICE_TYPE_GPU) != 0   ? DeviceKind::kOpenClGpu
              : (type & CL_DEVICE_TYPE_CPU) != 0 ? DeviceKind::kOpenClCpu
                                                 : DeviceKind::kOpenClOther;
  info.platform = PlatformText(platform, CL_PLATFORM_NAME);
  info.name = DeviceText(device, CL_DEVICE_NAME);
  info.version = "driver " + DeviceText(device, CL_DRIVER_VERSION) + ", " +
                 DeviceText(device, CL_DEVICE_OPENCL_C_VERSION);
  cl_uint units = 0;
  clGetDeviceInfo(device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof(units), &units, nullptr);
  info.compute_units = static_cast<int>(units);
  return info;
}

int Preference(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::kOpenClGpu:
      return 0;
    case DeviceKind::kOpenClCpu:
      return 1;
    default:
      return 2;
  }
}

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool Contains(const std::string& text, const std::string& lower_part) {
  return Lower(text).find(lower_part) != std::string::npos;
}

bool HasType(DeviceKind kind, const std::string& lower_type) {
  if (lower_type.empty()) return true;
  if (lower_type == "gpu") return kind == DeviceKind::kOpenClGpu;
  if (lower_type == "cpu") return kind == DeviceKind::kOpenClCpu;
  if (lower_type == "accelerator") return kind == DeviceKind::kOpenClOther;
  return false;
}

bool IsIndex(const std::string& text) {
  return !text.empty() && text.size() < 6 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string TypeName(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::kOpenClGpu:
      return "GPU";
    case DeviceKind::kOpenClCpu:
      return "CPU";
    default:
      return "ACCELERATOR";
  }
}

std::string DeviceText(cl_device_id device, cl_device_info what) {
  std::size_t size = 0;
  if (clGetDeviceInfo(device, what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return "";
  std::string text(size, '\0');
  if (clGetDeviceInfo(device, what, size, text.data(), nullptr) != CL_SUCCESS) return "";
  text.resize(size - 1);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::vector<Device> ListDevices() {
  cl_uint platform_count = 0;
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS || platform_count == 0) return {};
  std::vector<cl_platform_id> platforms(platform_count);
  if (clGetPlatformIDs(platform_count, platforms.data(), nullptr) != CL_SUCCESS) return {};

  std::vector<Device> devices;
  for (cl_platform_id platform : platforms) {
    cl_uint count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(count);
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr) != CL_SUCCESS) {
      continue;
    }
    for (cl_device_id id : ids) devices.push_back({platform, id, Describe(platform, id)});
  }
  std::stable_sort(devices.begin(), devices.end(), [](const Device& a, const Device& b) {
    return Preference(a.info.kind) < Preference(b.info.kind);
  });
  std::vector<DeviceInfo> infos;
  for (const Device& device : devices) infos.push_back(device.info);
  for (std::size_t i = 0; i < devices.size(); ++i) devices[i].info.selector = SelectorOf(infos, i);
  return devices;
}

std::string SelectorOf(const std::vector<DeviceInfo>& devices, std::size_t index) {
  const DeviceInfo& device = devices[index];
  const std::string kind = device.platform + ":" + TypeName(device.kind) + ":";
  std::string selector = kind + device.name;
  for (std::size_t i = 0; i < devices.size() && SelectDevice(devices, selector) != index; ++i) {
    selector = kind + std::to_string(i);
  }
  return selector;
}

std::optional<std::size_t> SelectDevice(const std::vector<DeviceInfo>& devices,
                                        const std::string& selector) {
  // The device's name may hold colons itself, so that only the first two separate.
  const std::size_t first = std::min(selector.find(':'), selector.size());
  const std::size_t second = std::min(selector.find(':', first + 1), selector.size());
  const std::string platform = Lower(selector.substr(0, first));
  const std::string type =
      first < selector.size() ? Lower(selector.substr(first + 1, second - first - 1)) : "";
  const std::string name = second < selector.size() ? Lower(selector.substr(second + 1)) : "";

  int index = IsIndex(name) ? std::stoi(name) : 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& device = devices[i];
    if (device.kind == DeviceKind::kCpuTwin || !Contains(device.platform, platform) ||
        !HasType(device.kind, type)) {
      continue;
    }
    if (!IsIndex(name) && !Contains(device.name, name)) continue;
    if (index == 0) return i;
    --index;
  }
  return std::nullopt;
}

}  // namespace windhover::opencl
