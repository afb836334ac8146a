// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>

#include "gpu-kernels/image.h"
#include "gpu-kernels/opencl/api.h"
#include "gpu-kernels/opencl/context.h"

namespace windhover::opencl {

// Work-items in all and in a group, per dimension; `global` must be a multiple of `local`.
struct WorkSize {
  std::array<std::size_t, 3> global = {1, 1, 1};
  std::array<std::size_t, 3> local = {1, 1, 1};
};

// The smallest multiple of `unit` that is at least `count`.
inline std::size_t RoundUp(std::size_t count, std::size_t unit) {
  return (count + unit - 1) / unit * unit;
}

// A kernel argument for a buffer that the kernel reads or writes: an image or a buffer.
class GlobalMemory {
 public:
  GlobalMemory(const Buffer& buffer) : memory_(&buffer) {}
  GlobalMemory(const Memory& memory) : memory_(&memory) {}
  template <typename T>
  GlobalMemory(const Image<T>& image) : memory_(&image.memory()) {}

  cl_mem In(cl_context context) const { return BufferOf(*memory_, context).get(); }

 private:
  const Memory* memory_;
};

// A kernel argument in __local memory of that many bytes.
struct LocalMemory {
  std::size_t size_bytes = 0;
};

// What Kernel does that does not depend on the argument types.
class KernelBase {
 protected:
  // Throws DeviceError where the program has no such kernel or it takes another number of
  // arguments.
  KernelBase(const Program& program, const std::string& name, std::size_t argument_count);

  void Set(const Queue&, cl_uint index, const LocalMemory& value) const {
    SetBytes(index, value.size_bytes, nullptr);
  }
  void Set(const Queue& queue, cl_uint index, const GlobalMemory& value) const {
    const cl_mem memory = value.In(queue.context());
    SetBytes(index, sizeof(memory), &memory);
  }
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void Set(const Queue&, cl_uint index, const T& value) const {
    SetBytes(index, sizeof(value), &value);
  }

  void Run(Queue& queue, const WorkSize& size) const;

 private:
  void SetBytes(cl_uint index, std::size_t size, const void* value) const;

  std::string kernel_name_;
  std::string name_;  // "<device>, kernel <name>", for error texts
  Handle<cl_kernel> kernel_;
};

// A kernel with the types of its arguments, in the order of the .cl file: GlobalMemory,
// LocalMemory, or plain values (cl_int, cl_float, cl_float16, ...) of the kernel's own sizes. One
// object is used by one thread at a time.
//
//   Kernel<GlobalMemory, cl_int, cl_float> scale(context.Compile(kScaleCl), "Scale");
//   scale.Enqueue(queue, {.global = {width, height, 1}, .local = {64, 1, 1}}, image, stride, 0.5F);
template <typename... Arguments>
class Kernel : private KernelBase {
 public:
  Kernel(const Program& program, const std::string& name)
      : KernelBase(program, name, sizeof...(Arguments)) {}

  // Returns at once; Queue::Finish waits. Throws DeviceError.
  void Enqueue(Queue& queue, const WorkSize& size,
               const std::type_identity_t<Arguments>&... arguments) const {
    cl_uint index = 0;
    (Set(queue, index++, arguments), ...);
    Run(queue, size);
  }
};

}  // namespace windhover::opencl
