// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "gpu-kernels/image.h"
#include "gpu-kernels/opencl/api.h"
#include "gpu-kernels/opencl/device.h"
#include "gpu-kernels/opencl/program_cache.h"
#include "gpu-kernels/opencl/stage_times.h"

namespace windhover::opencl {

class Context;

// Device memory that the host can map. On devices that share the host's memory mapping costs no
// copy.
class Buffer : public Memory {
 public:
  Buffer(const Context& context, std::size_t size_bytes);

  std::byte* Map(Access access) override;
  void Unmap(std::byte* pointer) noexcept override;

  cl_mem get() const { return memory_.get(); }
  cl_context context() const { return context_.get(); }
  std::size_t size_bytes() const { return size_bytes_; }

 private:
  std::string device_;
  Handle<cl_context> context_;
  Handle<cl_command_queue> queue_;
  StageObserver observe_;
  Handle<cl_mem> memory_;
  std::size_t size_bytes_;
};

// An in-order command queue; used by one thread at a time.
class Queue {
 public:
  explicit Queue(const Context& context);

  // Copies bytes to the start of a buffer; they must stay where they are until Finish.
  void EnqueueWrite(const Buffer& buffer, const void* bytes, std::size_t size_bytes);
  // Copies bytes from the start of a buffer, after all that was enqueued has run: no Finish needed.
  void Read(const Buffer& buffer, void* bytes, std::size_t size_bytes);

  // Waits until all that was enqueued has run. Throws DeviceError where some of it failed.
  void Finish();

  // Where the next call shall put its event, so that its time can be told; mostly null.
  cl_event* EventOf(const std::string& stage) { return times_.Next(stage); }

  cl_command_queue get() const { return queue_.get(); }
  cl_context context() const { return context_.get(); }
  const std::string& device() const { return device_; }

 private:
  std::string device_;
  Handle<cl_context> context_;
  Handle<cl_command_queue> queue_;
  StageTimes times_;
};

// A compiled program; copies share it.
struct Program {
  Handle<cl_program> handle;
  std::string device;       // for error texts
  bool from_cache = false;  // read from the program cache instead of being compiled
};

// One device, opened. Thread-safe. Always owned by a shared_ptr: what needs it later than in its
// constructor keeps shared_from_this(). Queues, buffers, programs and kernels may outlive it.
class Context : public std::enable_shared_from_this<Context> {
 public:
  // With `observe`, all queues note times and tell it.
  Context(const Device& device, ProgramCache cache, StageObserver observe = {});

  const DeviceInfo& device() const { return device_.info; }
  // The name that error texts use.
  const std::string& name() const { return name_; }
  // Empty unless stages are observed.
  const StageObserver& observe() const { return observe_; }
  bool is_cpu() const { return device_.info.kind == DeviceKind::kOpenClCpu; }
  // Whether the device works in the host's memory, so that mapping costs no copy.
  bool shares_host_memory() const { return shares_host_memory_; }
  // Elements of the float vectors that kernels should use: 4, 8 or 16 on CPUs, 1 elsewhere.
  int float_lanes() const { return float_lanes_; }

  // The program of an embedded source (kernel_sources.h), or of several joined, under compiler
  // options such as "-DV=16"; "-cl-std=CL1.2" is always added. Compiled once in a process, and read
  // from the program cache where that has it. Throws DeviceError with the compiler's log.
  Program Compile(std::string_view source, const std::string& options = "");

  // Writes the programs that were compiled here, not read, to the program cache once more. Some
  // drivers, PoCL among them, finish compiling at a kernel's first launch and can put the result
  // into binaries that are taken later.
  void StorePrograms();

  std::unique_ptr<Buffer> Allocate(std::size_t size_bytes) const;

  cl_context get() const { return context_.get(); }
  cl_device_id device_id() const { return device_.id; }
  const Handle<cl_context>& handle() const { return context_; }
  // The queue on which buffers are mapped.
  const Handle<cl_command_queue>& map_queue() const { return map_queue_; }

 private:
  Handle<cl_program> BuildFromBinary(const std::vector<unsigned char>& binary,
                                     const std::string& options) const;
  Handle<cl_program> BuildFromSource(std::string_view source, const std::string& options) const;
  std::vector<unsigned char> BinaryOf(const Handle<cl_program>& program) const;

  Device device_;
  std::string name_;
  ProgramCache cache_;
  StageObserver observe_;
  int float_lanes_ = 1;
  bool shares_host_memory_ = false;
  Handle<cl_context> context_;
  Handle<cl_command_queue> map_queue_;

  struct Compiled {
    Program program;
    std::string source;
    std::string options;
  };
  std::mutex mutex_;                          // guards programs_
  std::map<std::string, Compiled> programs_;  // by the program cache's key
};

// The buffer behind an image or other memory. Throws std::invalid_argument where it was not made by
// the backend of `context`.
const Buffer& BufferOf(const Memory& memory, cl_context context);

}  // namespace windhover::opencl
