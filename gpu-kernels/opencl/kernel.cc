// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/kernel.h"

#include "gpu-kernels/backend.h"

namespace windhover::opencl {

KernelBase::KernelBase(const Program& program, const std::string& name, std::size_t argument_count)
    : kernel_name_(name), name_(program.device + ", kernel " + name) {
  cl_int code = CL_SUCCESS;
  kernel_ = Handle<cl_kernel>(clCreateKernel(program.handle.get(), name.c_str(), &code));
  Check(code, "clCreateKernel", name_);
  cl_uint count = 0;
  WINDHOVER_CL(name_,
               clGetKernelInfo(kernel_.get(), CL_KERNEL_NUM_ARGS, sizeof(count), &count, nullptr));
  if (count != argument_count) {
    throw DeviceError(name_ + ": takes " + std::to_string(count) + " arguments, not " +
                      std::to_string(argument_count));
  }
}

void KernelBase::SetBytes(cl_uint index, std::size_t size, const void* value) const {
  const cl_int code = clSetKernelArg(kernel_.get(), index, size, value);
  if (code != CL_SUCCESS) Check(code, "clSetKernelArg " + std::to_string(index), name_);
}

void KernelBase::Run(Queue& queue, const WorkSize& size) const {
  WINDHOVER_CL(name_,
               clEnqueueNDRangeKernel(queue.get(), kernel_.get(), 3, nullptr, size.global.data(),
                                      size.local.data(), 0, nullptr, queue.EventOf(kernel_name_)));
}

}  // namespace windhover::opencl
