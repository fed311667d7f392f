// What sealing costs: build/release/bin/link_test --gtest_filter='Cost.*'

#include <gtest/gtest.h>

#include "firmware/app/heap_counter.h"
#include "firmware/link/seal.h"
#include "tests/link/golden_messages.h"
#include "tests/support/cost.h"

namespace armada {
namespace {

TEST(Cost, OfAuthenticationIsAtMostTwoMicrosecondsAMessage) {
  if (!HeapCounter::available()) GTEST_SKIP() << "sanitizers cost more than they judge";
  const FleetKey key{1, 2, 3};
  Sealer sealer({key, 1}, 7);
  SealCheck check(key, 7);
  MessageBuffer buffer;
  const size_t size = Encode(GoldenEstimate(), &buffer).size();
  std::span<const uint8_t> sealed;
  const auto seal = [&] { sealed = sealer.Seal("EST_7", std::span(buffer).first(size), &buffer); };
  const double seal_us = Cost_us("sealing an estimate", seal);
  EXPECT_LT(seal_us, 2.0);
  bool genuine = true;
  const double both_us = Cost_us("sealing one and opening it", [&] {
    seal();
    genuine = genuine && check.Open("EST_7", &sealed) == SealVerdict::kGenuine;
  });
  EXPECT_TRUE(genuine);
  EXPECT_LT(both_us - seal_us, 2.0);
}

}  // namespace
}  // namespace armada
