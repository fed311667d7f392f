#include "firmware/link/seal.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/link/golden_bytes.h"
#include "tests/link/golden_messages.h"
#include "tests/support/hex.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

constexpr int kSender = 7;
constexpr char kChannel[] = "EST_7";

FleetKey CountingKey() {
  FleetKey key;
  std::iota(key.begin(), key.end(), uint8_t{0});
  return key;
}

class SealTest : public testing::Test {
 protected:
  /// A sealed estimate, as it would come from the wire.
  std::vector<uint8_t> Sealed(Sealer* sealer, const char* channel = kChannel) {
    const auto sealed = sealer->Seal(channel, Encode(GoldenEstimate(), &buffer_), &buffer_);
    return {sealed.begin(), sealed.end()};
  }
  SealVerdict Open(const std::vector<uint8_t>& bytes, const char* channel = kChannel) {
    opened_ = bytes;
    return check_.Open(channel, &opened_);
  }

  MessageBuffer buffer_{};
  Sealer sealer_{{CountingKey(), 3}, kSender};
  SealCheck check_{CountingKey(), kSender};
  std::span<const uint8_t> opened_;
};

TEST_F(SealTest, IsWhatPythonsBlake2bMakesOfTheSame) {
  EXPECT_EQ(Hex(Sealed(&sealer_)), kSealedEstimateHex);
}

TEST_F(SealTest, GivesTheMessageBack) {
  const std::vector<uint8_t> sealed = Sealed(&sealer_);
  ASSERT_EQ(Open(sealed), SealVerdict::kGenuine);
  EXPECT_EQ(Hex(opened_), kEstimateHex);
}

TEST_F(SealTest, EveryChangedBitIsSeen) {
  const std::vector<uint8_t> sealed = Sealed(&sealer_);
  for (size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
    std::vector<uint8_t> changed = sealed;
    changed[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    ASSERT_EQ(Open(changed), SealVerdict::kForged) << "bit " << bit;
  }
  EXPECT_EQ(Open(sealed), SealVerdict::kGenuine) << "forgeries leave no trace";
}

TEST_F(SealTest, EveryOtherLengthIsSeen) {
  std::vector<uint8_t> sealed = Sealed(&sealer_);
  for (size_t size = 0; size < sealed.size(); ++size) {
    ASSERT_EQ(Open({sealed.begin(), sealed.begin() + static_cast<std::ptrdiff_t>(size)}),
              SealVerdict::kForged);
  }
  sealed.push_back(0);
  EXPECT_EQ(Open(sealed), SealVerdict::kForged);
}

TEST_F(SealTest, ASealOfAnotherChannelSenderOrFleetIsForged) {
  EXPECT_EQ(Open(Sealed(&sealer_, "TEL_7")), SealVerdict::kForged);
  Sealer other_sender({CountingKey(), 3}, kSender + 1);
  EXPECT_EQ(Open(Sealed(&other_sender)), SealVerdict::kForged);
  FleetKey other_key = CountingKey();
  other_key[31] ^= 1;
  Sealer other_fleet({other_key, 3}, kSender);
  EXPECT_EQ(Open(Sealed(&other_fleet)), SealVerdict::kForged);
}

TEST_F(SealTest, RepeatedAndOvertakenMessagesAreReplays) {
  const std::vector<uint8_t> first = Sealed(&sealer_);
  const std::vector<uint8_t> second = Sealed(&sealer_);
  const std::vector<uint8_t> third = Sealed(&sealer_);
  EXPECT_EQ(Open(second), SealVerdict::kGenuine);
  EXPECT_EQ(Open(second), SealVerdict::kReplayed);
  EXPECT_EQ(Open(first), SealVerdict::kReplayed);
  EXPECT_EQ(Open(third), SealVerdict::kGenuine);
}

TEST_F(SealTest, ARestartedSenderIsBelievedAtOnceAndItsFormerLifeNoMore) {
  Sealed(&sealer_);
  const std::vector<uint8_t> former = Sealed(&sealer_);
  const std::vector<uint8_t> formers_next = Sealed(&sealer_);
  EXPECT_EQ(Open(former), SealVerdict::kGenuine);
  Sealer restarted({CountingKey(), 4}, kSender);
  EXPECT_EQ(Open(Sealed(&restarted)), SealVerdict::kGenuine);
  EXPECT_EQ(Open(formers_next), SealVerdict::kReplayed);
}

TEST_F(SealTest, TakesNoHeap) {
  const auto message = Encode(GoldenEstimate(), &buffer_);
  const LimitMalloc none;
  std::span<const uint8_t> sealed = sealer_.Seal(kChannel, message, &buffer_);
  EXPECT_EQ(check_.Open(kChannel, &sealed), SealVerdict::kGenuine);
}

}  // namespace
}  // namespace armada
