// SPDX-License-Identifier: Apache-2.0
#include "tests/support/allocation_count.h"

#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t allocations = 0;

void* CountedAllocation(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* pointer = nullptr;
  const std::size_t wanted = size == 0 ? 1 : size;
  if (posix_memalign(&pointer, alignment, wanted) != 0) throw std::bad_alloc();
  return pointer;
}

}  // namespace

namespace windhover {

std::size_t AllocationCount() { return allocations; }

}  // namespace windhover

void* operator new(std::size_t size) { return CountedAllocation(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return CountedAllocation(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* pointer) noexcept { std::free(pointer); }
void operator delete(void* pointer, std::size_t) noexcept { std::free(pointer); }
void operator delete(void* pointer, std::align_val_t) noexcept { std::free(pointer); }
void operator delete(void* pointer, std::size_t, std::align_val_t) noexcept { std::free(pointer); }
