#include "firmware/app/heap_counter.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <string>

#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

template <class Allocate>
uint64_t Allocations(Allocate allocate) {
  const uint64_t before = HeapCounter::Allocations();
  void* volatile memory = allocate();  // volatile: the compiler must not leave the pair out
  const uint64_t after = HeapCounter::Allocations();
  std::free(memory);
  return after - before;
}

TEST(HeapCounter, IsLeftOutOnlyUnderSanitizers) {
#ifdef ARMADA_SANITIZED
  EXPECT_FALSE(HeapCounter::available());
#else
  EXPECT_TRUE(HeapCounter::available());
#endif
}

TEST(HeapCounter, CountsEveryWayToAllocate) {
  const uint64_t one = HeapCounter::available() ? 1 : 0;
  EXPECT_EQ(Allocations([] { return std::malloc(10); }), one);
  EXPECT_EQ(Allocations([] { return std::calloc(10, 10); }), one);
  EXPECT_EQ(Allocations([] { return std::realloc(nullptr, 10); }), one);
  EXPECT_EQ(Allocations([] { return std::aligned_alloc(64, 640); }), one);
  EXPECT_EQ(Allocations([] {
              void* memory = nullptr;
              return posix_memalign(&memory, 64, 640) == 0 ? memory : nullptr;
            }),
            one);
  const uint64_t before = HeapCounter::Allocations();
  const std::unique_ptr<std::string> text(new std::string(1000, 'x'));
  EXPECT_EQ(HeapCounter::Allocations() - before, 2 * one) << "the string and its characters";
}

TEST(HeapCounter, AllocatesAsTheCAllocatorDoes) {
  void* memory = nullptr;
  if (HeapCounter::available()) {  // a sanitizer would end the process
    EXPECT_EQ(posix_memalign(&memory, 24, 100), EINVAL) << "not a power of two";
  }
  ASSERT_EQ(posix_memalign(&memory, 4096, 100), 0);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(memory) % 4096, 0u);
  std::free(memory);
  auto* numbers = static_cast<unsigned char*>(std::calloc(100, 10));
  EXPECT_EQ(std::count(numbers, numbers + 1000, 0), 1000);
  numbers[999] = 7;
  numbers = static_cast<unsigned char*>(std::realloc(numbers, 100000));
  EXPECT_EQ(numbers[999], 7);
  std::free(numbers);
}

TEST(LimitMalloc, PassesWhereNothingAllocates) {
  const LimitMalloc guard;
  volatile int sum = 0;
  for (int i = 0; i < 10; ++i) sum = sum + i;
}

void AllocateUnderTheGuard() {
  const LimitMalloc guard;
  void* volatile memory = std::malloc(10);
  std::free(memory);
}

TEST(LimitMalloc, FailsWhereSomethingAllocates) {
  if (HeapCounter::available()) {
    EXPECT_NONFATAL_FAILURE(AllocateUnderTheGuard(), "heap allocations");
  } else {
    AllocateUnderTheGuard();  // nothing can be counted, so nothing may fail
  }
}

}  // namespace
}  // namespace armada
