// SPDX-License-Identifier: Apache-2.0
#pragma once

// Nothing newer than OpenCL 1.2 is used.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <string>
#include <string_view>
#include <utility>

namespace windhover::opencl {

// "CL_OUT_OF_RESOURCES" and so on; "OpenCL error -9999" for codes unknown here.
std::string CodeName(cl_int code);

// Throws DeviceError "<device>: <call>: <code>" unless `code` is CL_SUCCESS.
void Check(cl_int code, std::string_view call, std::string_view device);

// Checks a call and keeps its text for the error: WINDHOVER_CL(device, clFinish(queue)).
#define WINDHOVER_CL(device, call) ::windhover::opencl::Check((call), #call, (device))

inline void Retain(cl_context object) { clRetainContext(object); }
inline void Release(cl_context object) { clReleaseContext(object); }
inline void Retain(cl_command_queue object) { clRetainCommandQueue(object); }
inline void Release(cl_command_queue object) { clReleaseCommandQueue(object); }
inline void Retain(cl_mem object) { clRetainMemObject(object); }
inline void Release(cl_mem object) { clReleaseMemObject(object); }
inline void Retain(cl_program object) { clRetainProgram(object); }
inline void Release(cl_program object) { clReleaseProgram(object); }
inline void Retain(cl_kernel object) { clRetainKernel(object); }
inline void Release(cl_kernel object) { clReleaseKernel(object); }
inline void Retain(cl_event object) { clRetainEvent(object); }
inline void Release(cl_event object) { clReleaseEvent(object); }

// One reference to an OpenCL object; copies count. Takes over the reference that it is made from.
template <typename T>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(const Handle& other) : object_(other.object_) {
    if (object_ != nullptr) Retain(object_);
  }
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() {
    if (object_ != nullptr) Release(object_);
  }

  T get() const { return object_; }
  // Where an OpenCL call shall put a new object; only for an empty handle.
  T* out() { return &object_; }

 private:
  T object_ = nullptr;
};

}  // namespace windhover::opencl
