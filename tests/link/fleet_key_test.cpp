#include "firmware/link/fleet_key.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temp_dir.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

class FleetKeyTest : public testing::Test {
 protected:
  FleetKeyTest() { EXPECT_TRUE(MakeFleetKey(path_, &error_)) << error_; }

  void Write(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }
  /// Why the key is refused; fails the test when it is not.
  std::string Refusal(const std::string& path) {
    EXPECT_FALSE(LoadFleetKey(path, &error_).has_value());
    return error_;
  }

  const TempDir temporary_;
  const fs::path folder_ = temporary_.path();
  const std::string path_ = folder_ / "fleet.key";
  std::string error_;
};

bool Has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(FleetKeyTest, ANewKeyIsItsOwnersAloneAndRandom) {
  struct stat status {};
  ASSERT_EQ(stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600u);
  const auto key = LoadFleetKey(path_, &error_);
  ASSERT_TRUE(key) << error_;
  const std::string other = folder_ / "other.key";
  ASSERT_TRUE(MakeFleetKey(other, &error_));
  EXPECT_NE(*key, *LoadFleetKey(other, &error_));
}

TEST_F(FleetKeyTest, ANewKeyNeverReplacesAFile) {
  const auto before = LoadFleetKey(path_, &error_);
  EXPECT_FALSE(MakeFleetKey(path_, &error_));
  EXPECT_TRUE(Has(error_, "exists")) << error_;
  EXPECT_EQ(before, LoadFleetKey(path_, &error_));
}

TEST_F(FleetKeyTest, AFileThatOthersMayReadOrWriteIsRefused) {
  for (const mode_t mode : {0640u, 0604u, 0620u, 0602u, 0601u, 0777u}) {
    ASSERT_EQ(chmod(path_.c_str(), mode), 0);
    EXPECT_TRUE(Has(Refusal(path_), "allowed are 0600 and 0400")) << error_;
  }
  ASSERT_EQ(chmod(path_.c_str(), 0400), 0);
  EXPECT_TRUE(LoadFleetKey(path_, &error_)) << error_;
}

TEST_F(FleetKeyTest, WhatIsNoKeyIsRefused) {
  EXPECT_TRUE(Has(Refusal(folder_ / "none"), "armada key new")) << error_;
  EXPECT_TRUE(Has(Refusal(folder_), "no regular file")) << error_;
  fs::create_symlink(path_, folder_ / "link");
  EXPECT_TRUE(Has(Refusal(folder_ / "link"), "symbolic link")) << error_;
  Write(std::string(31, 'k'));
  EXPECT_TRUE(Has(Refusal(path_), "has 31 bytes, a key has 32")) << error_;
  Write(std::string(33, 'k'));
  EXPECT_TRUE(Has(Refusal(path_), "has 33 bytes, a key has 32")) << error_;
  Write(std::string(32, '\0'));
  EXPECT_TRUE(Has(Refusal(path_), "all zeros")) << error_;
}

}  // namespace
}  // namespace armada
