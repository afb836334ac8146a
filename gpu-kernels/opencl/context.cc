// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/context.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

namespace windhover::opencl {
namespace {

Handle<cl_command_queue> MakeQueue(const Context& context) {
  const cl_command_queue_properties properties = context.observe() ? CL_QUEUE_PROFILING_ENABLE : 0;
  cl_int code = CL_SUCCESS;
  Handle<cl_command_queue> queue(
      clCreateCommandQueue(context.get(), context.device_id(), properties, &code));
  Check(code, "clCreateCommandQueue", context.name());
  return queue;
}

std::string BuildLog(cl_program program, cl_device_id device) {
  std::size_t size = 0;
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
  std::string log(size, '\0');
  if (size > 0) {
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    log.resize(size - 1);
  }
  return log;
}

}  // namespace

Buffer::Buffer(const Context& context, std::size_t size_bytes)
    : device_(context.name()),
      context_(context.handle()),
      queue_(context.map_queue()),
      observe_(context.observe()),
      size_bytes_(size_bytes) {
  if (size_bytes == 0) throw std::invalid_argument("memory of 0 bytes asked for");
  // Drivers of devices with memory of their own would keep such a buffer in the host's, where every
  // access goes over the bus.
  const cl_mem_flags place = context.shares_host_memory() ? CL_MEM_ALLOC_HOST_PTR : 0;
  cl_int code = CL_SUCCESS;
  memory_ = Handle<cl_mem>(
      clCreateBuffer(context.get(), CL_MEM_READ_WRITE | place, size_bytes, nullptr, &code));
  Check(code, "clCreateBuffer of " + std::to_string(size_bytes) + " bytes", device_);
}

std::byte* Buffer::Map(Access access) {
  const cl_map_flags flags = access == Access::kRead ? CL_MAP_READ : CL_MAP_WRITE_INVALIDATE_REGION;
  StageTimes times(observe_);
  cl_int code = CL_SUCCESS;
  void* pointer = clEnqueueMapBuffer(queue_.get(), memory_.get(), CL_TRUE, flags, 0, size_bytes_, 0,
                                     nullptr, times.Next("map"), &code);
  Check(code, "clEnqueueMapBuffer", device_);
  times.Report();
  return static_cast<std::byte*>(pointer);
}

void Buffer::Unmap(std::byte* pointer) noexcept {
  // Other queues do not wait for this one: what was written must have arrived when this returns.
  Handle<cl_event> done;
  if (clEnqueueUnmapMemObject(queue_.get(), memory_.get(), pointer, 0, nullptr, done.out()) ==
      CL_SUCCESS) {
    const cl_event event = done.get();
    clWaitForEvents(1, &event);
    StageTimes times(observe_);
    times.Add("unmap", std::move(done));
    times.Report();
  }
}

Queue::Queue(const Context& context)
    : device_(context.name()),
      context_(context.handle()),
      queue_(MakeQueue(context)),
      times_(context.observe()) {}

void Queue::EnqueueWrite(const Buffer& buffer, const void* bytes, std::size_t size_bytes) {
  WINDHOVER_CL(device_, clEnqueueWriteBuffer(queue_.get(), buffer.get(), CL_FALSE, 0, size_bytes,
                                             bytes, 0, nullptr, EventOf("write")));
}

void Queue::Read(const Buffer& buffer, void* bytes, std::size_t size_bytes) {
  WINDHOVER_CL(device_, clEnqueueReadBuffer(queue_.get(), buffer.get(), CL_TRUE, 0, size_bytes,
                                            bytes, 0, nullptr, EventOf("read")));
  times_.Report();
}

void Queue::Finish() {
  WINDHOVER_CL(device_, clFinish(queue_.get()));
  times_.Report();
}

Context::Context(const Device& device, ProgramCache cache, StageObserver observe)
    : device_(device),
      name_(device.info.Describe()),
      cache_(std::move(cache)),
      observe_(std::move(observe)) {
  const cl_context_properties properties[] = {
      CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(device.platform), 0};
  cl_int code = CL_SUCCESS;
  context_ =
      Handle<cl_context>(clCreateContext(properties, 1, &device.id, nullptr, nullptr, &code));
  Check(code, "clCreateContext", name_);
  map_queue_ = MakeQueue(*this);

  cl_bool unified = CL_FALSE;
  WINDHOVER_CL(name_, clGetDeviceInfo(device.id, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof(unified),
                                      &unified, nullptr));
  shares_host_memory_ = unified == CL_TRUE;
  cl_uint lanes = 1;
  WINDHOVER_CL(name_, clGetDeviceInfo(device.id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof(lanes),
                                      &lanes, nullptr));
  if (is_cpu()) float_lanes_ = lanes >= 16 ? 16 : lanes >= 8 ? 8 : 4;
}

std::unique_ptr<Buffer> Context::Allocate(std::size_t size_bytes) const {
  return std::make_unique<Buffer>(*this, size_bytes);
}

Program Context::Compile(std::string_view source, const std::string& options) {
  const std::string all_options = "-cl-std=CL1.2 " + options;
  // A program runs on the very device, driver and compiler that it was made by, and on no other.
  std::string key;
  for (const std::string& part :
       {device_.info.platform, device_.info.name, DeviceText(device_.id, CL_DEVICE_VERSION),
        DeviceText(device_.id, CL_DRIVER_VERSION), all_options}) {
    key += part + '\n';
  }
  key += source;

  const std::lock_guard lock(mutex_);
  if (const auto found = programs_.find(key); found != programs_.end())
    return found->second.program;

  Program program;
  program.device = name_;
  if (const auto binary = cache_.Load(key)) {
    program.handle = BuildFromBinary(*binary, all_options);
    program.from_cache = program.handle.get() != nullptr;
  }
  if (!program.from_cache) {
    program.handle = BuildFromSource(source, all_options);
    cache_.Store(key, BinaryOf(program.handle));
  }
  programs_.emplace(std::move(key), Compiled{program, std::string(source), all_options});
  return program;
}

void Context::StorePrograms() {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, compiled] : programs_) {
    if (compiled.program.from_cache) continue;
    // A program's binary does not change once it was taken; that of a new one has what the driver
    // has compiled of the same source since.
    cache_.Store(key, BinaryOf(BuildFromSource(compiled.source, compiled.options)));
  }
}

// An empty handle where the driver does not take the binary.
Handle<cl_program> Context::BuildFromBinary(const std::vector<unsigned char>& binary,
                                            const std::string& options) const {
  const std::size_t size = binary.size();
  const unsigned char* data = binary.data();
  cl_int status = CL_SUCCESS;
  cl_int code = CL_SUCCESS;
  Handle<cl_program> program(
      clCreateProgramWithBinary(get(), 1, &device_.id, &size, &data, &status, &code));
  if (code != CL_SUCCESS || status != CL_SUCCESS ||
      clBuildProgram(program.get(), 1, &device_.id, options.c_str(), nullptr, nullptr) !=
          CL_SUCCESS) {
    return {};
  }
  return program;
}

Handle<cl_program> Context::BuildFromSource(std::string_view source,
                                            const std::string& options) const {
  const char* text = source.data();
  const std::size_t size = source.size();
  cl_int code = CL_SUCCESS;
  Handle<cl_program> program(clCreateProgramWithSource(get(), 1, &text, &size, &code));
  Check(code, "clCreateProgramWithSource", name_);
  code = clBuildProgram(program.get(), 1, &device_.id, options.c_str(), nullptr, nullptr);
  if (code != CL_SUCCESS) {
    Check(code, "clBuildProgram " + options + "\n" + BuildLog(program.get(), device_.id) + "\n",
          name_);
  }
  return program;
}

std::vector<unsigned char> Context::BinaryOf(const Handle<cl_program>& program) const {
  std::size_t size = 0;
  WINDHOVER_CL(name_, clGetProgramInfo(program.get(), CL_PROGRAM_BINARY_SIZES, sizeof(size), &size,
                                       nullptr));
  std::vector<unsigned char> binary(size);
  unsigned char* data = binary.data();
  WINDHOVER_CL(name_,
               clGetProgramInfo(program.get(), CL_PROGRAM_BINARIES, sizeof(data), &data, nullptr));
  return binary;
}

const Buffer& BufferOf(const Memory& memory, cl_context context) {
  const auto* buffer = dynamic_cast<const Buffer*>(&memory);
  if (buffer == nullptr || buffer->context() != context) {
    throw std::invalid_argument("the image belongs to another backend");
  }
  return *buffer;
}

}  // namespace windhover::opencl
