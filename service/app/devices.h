// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace windhover {

// Prints the compute devices, the one that `device` (see Backend::Create) chooses marked, and why
// it does. Returns the exit code. Throws DeviceError where none fits.
int ListDevices(const std::string& device);

// Compiles the kernels for the device that `device` chooses and fills the program cache, and prints
// what it is doing. Returns the exit code. Throws DeviceError.
int WarmUpDevice(const std::string& device);

}  // namespace windhover
