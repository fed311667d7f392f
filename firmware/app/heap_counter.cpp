#include "firmware/app/heap_counter.h"

#ifdef ARMADA_SANITIZED

namespace armada {

bool HeapCounter::available() {
  return false;
}
uint64_t HeapCounter::Allocations() {
  return 0;
}

}  // namespace armada

#else

#include <atomic>
#include <bit>
#include <cerrno>
#include <cstddef>

namespace {

// Constant-initialised: malloc is called before any constructor has run.
constinit std::atomic<uint64_t> allocations{0};

void Count() {
  allocations.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

namespace armada {

bool HeapCounter::available() {
  return true;
}
uint64_t HeapCounter::Allocations() {
  return allocations.load(std::memory_order_relaxed);
}

}  // namespace armada

// glibc's own names of its allocator; free() and the rest stay glibc's and go with them.
extern "C" {

// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(size_t size) noexcept {
  Count();
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) noexcept {
  Count();
  return __libc_calloc(count, size);
}

void* realloc(void* old, size_t size) noexcept {
  Count();
  return __libc_realloc(old, size);
}

void* memalign(size_t alignment, size_t size) noexcept {
  Count();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(size_t alignment, size_t size) noexcept {
  Count();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** result, size_t alignment, size_t size) noexcept {
  if (alignment % sizeof(void*) != 0 || !std::has_single_bit(alignment)) return EINVAL;
  Count();
  void* memory = __libc_memalign(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *result = memory;
  return 0;
}

}  // extern "C"

#endif
