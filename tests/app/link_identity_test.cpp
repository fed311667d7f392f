#include "firmware/app/link_identity.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temp_dir.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

class LinkIdentityTest : public testing::Test {
 protected:
  LinkIdentityTest() {
    link_.key_file = folder_ / "fleet.key";
    EXPECT_TRUE(MakeFleetKey(link_.key_file, &error_)) << error_;
  }

  bool Take(int sender) { return TakeIdentity(link_, sender, state_, &identity_, &error_); }

  const TempDir temporary_;
  const fs::path folder_ = temporary_.path();
  const std::string state_ = folder_ / "state";
  LcmLinkConfig link_;
  std::optional<LinkIdentity> identity_;
  std::string error_;
};

TEST_F(LinkIdentityTest, EveryStartOfASenderIsANewEpoch) {
  for (uint64_t start = 1; start <= 12; ++start) {
    ASSERT_TRUE(Take(3)) << error_;
    EXPECT_EQ(identity_->epoch, start);
  }
  ASSERT_TRUE(Take(4)) << error_;
  EXPECT_EQ(identity_->epoch, 1u) << "senders count by themselves";
}

TEST_F(LinkIdentityTest, WithoutTheLastEpochNothingIsSent) {
  ASSERT_TRUE(Take(3));
  for (const char* text :
       {"", "x\n", "-1\n", "7", "7 \n", "18446744073709551615\n", "99999999999999999999\n"}) {
    std::ofstream(state_ + "/epoch_3") << text;
    EXPECT_FALSE(Take(3)) << text;
    EXPECT_NE(error_.find("epoch_3"), std::string::npos) << error_;
    EXPECT_FALSE(identity_.has_value());
  }
}

TEST_F(LinkIdentityTest, AnEpochThatCannotBeKeptIsNotUsed) {
  std::ofstream(folder_ / "file") << "in the way";
  EXPECT_FALSE(TakeIdentity(link_, 3, folder_ / "file", &identity_, &error_));
  EXPECT_FALSE(identity_.has_value());
}

TEST_F(LinkIdentityTest, AFleetWithoutAKeyHasNoneAndIsWarnedOf) {
  EXPECT_EQ(WarningOf(link_), "");
  link_.key_file = LcmLinkConfig().key_file;
  EXPECT_TRUE(Take(3));
  EXPECT_FALSE(identity_.has_value());
  EXPECT_NE(WarningOf(link_).find("WARNING"), std::string::npos);
}

TEST_F(LinkIdentityTest, AKeyThatOthersCanReadIsRefused) {
  fs::permissions(link_.key_file, fs::perms::others_read, fs::perm_options::add);
  EXPECT_FALSE(Take(3));
  EXPECT_FALSE(fs::exists(state_)) << "nothing is half started";
}

}  // namespace
}  // namespace armada
