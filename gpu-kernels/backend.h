// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu-kernels/image.h"

namespace windhover {

class Decimate;
class DifferenceThreshold;
class PhaseCorrelation;
struct PhaseCorrelationSettings;
class TemporalMedian;
class Warp;

// The device is unknown, or it failed. The text names the device and the call that failed.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Is told what a stage took on the device: a kernel by its name, or a transfer ("write", "read",
// "map", "unmap"). Called by whichever thread ran it, after it has ended; must not throw.
using StageObserver = std::function<void(const std::string& stage, double ms)>;

enum class DeviceKind { kCpuTwin, kOpenClCpu, kOpenClGpu, kOpenClOther };

struct DeviceInfo {
  DeviceKind kind = DeviceKind::kCpuTwin;
  std::string platform;  // OpenCL platform name, empty for the CPU twin
  std::string name;      // device name
  std::string version;   // driver and OpenCL C version, for people
  int compute_units = 0;
  // The text that selects exactly this device: "<platform>:<CPU|GPU>:<name>", or with its index in
  // place of a name that others share, or "cpu".
  std::string selector;

  // "OpenCL CPU 'name' (platform)" or "CPU twin", for logs and the summary line.
  std::string Describe() const;
};

// Makes images and the operators that work on them, all on one device, chosen once. Thread-safe;
// what it makes is not: an operator is used by one thread at a time, and so is an image while it is
// written; once written, several threads may read it. Operators run to their end before they
// return, so that results may be handed to another thread or operator at once. Operators refuse
// (std::invalid_argument) images of the wrong size.
class Backend {
 public:
  // Receives one line of text for people, e.g. why there is no OpenCL.
  using Warn = std::function<void(const std::string&)>;

  // `device` is
  //   ""      the environment variable WINDHOVER_DEVICE; where that is unset or empty, the first
  //           OpenCL GPU, else the first OpenCL CPU; where no OpenCL platform is installed, the CPU
  //           twin, with one warning,
  //   "cpu"   the CPU twin (no OpenCL),
  //   "<platform>:<CPU|GPU>:<name|id>"   an OpenCL device: parts of the platform's and the device's
  //           name, or the device's index among those of that platform and type; each part may be
  //           empty. This is OpenCV's grammar.
  // Throws DeviceError, listing the devices there are, when none fits.
  //
  // With `observe` the device notes times, which costs a little. The CPU twin has no stages to
  // tell.
  static std::shared_ptr<Backend> Create(const std::string& device = "", const Warn& warn = {},
                                         const StageObserver& observe = {});

  // All OpenCL devices in the order of preference, then the CPU twin.
  static std::vector<DeviceInfo> Devices();

  virtual ~Backend() = default;

  virtual const DeviceInfo& device() const = 0;

  // `size_bytes` > 0; contents unspecified. Throws DeviceError.
  virtual std::unique_ptr<Memory> Allocate(std::size_t size_bytes) = 0;

  // Width and height in px, both > 0; contents unspecified.
  template <typename T>
  Image<T> MakeImage(int width, int height) {
    const std::ptrdiff_t per_row = 64 / sizeof(T);
    const std::ptrdiff_t stride = (width + per_row - 1) / per_row * per_row;
    return Image<T>(Allocate(stride * height * sizeof(T)), width, height, stride);
  }
  BitImage MakeBitImage(int width, int height) {
    return {MakeImage<std::uint32_t>((width + 31) / 32, height), width, height};
  }

  virtual std::unique_ptr<Decimate> MakeDecimate() = 0;
  virtual std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() = 0;
  virtual std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(
      const PhaseCorrelationSettings& settings) = 0;
  virtual std::unique_ptr<TemporalMedian> MakeTemporalMedian() = 0;
  virtual std::unique_ptr<Warp> MakeWarp() = 0;

  // Compiles every kernel that the operators can need and fills the program cache; nothing to do on
  // the CPU twin. Calls `progress` with the kernel's name before each one.
  virtual void WarmUp(const std::function<void(const std::string&)>& progress) = 0;
};

}  // namespace windhover
