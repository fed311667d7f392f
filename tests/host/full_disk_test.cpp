// Files of a run on a disk that has no room: /dev/full in their place.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "host/metrics.h"
#include "host/sim/trace_writer.h"
#include "tests/support/temp_dir.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

class FullDiskTest : public testing::Test {
 protected:
  std::string In(const std::string& name) const { return (temp_.path() / name).string(); }
  std::string Full(const std::string& name) const {
    fs::create_symlink("/dev/full", In(name));
    return In(name);
  }

  TempDir temp_;
  std::string error_;
};

TEST_F(FullDiskTest, AResultIsWholeOrNotThereAndSaysWhy) {
  const std::string part = Full("metrics.json.part");
  EXPECT_FALSE(WriteJson({{"ok", true}}, In("metrics.json"), &error_));
  EXPECT_EQ(error_, "cannot write " + In("metrics.json") + ": No space left on device");
  EXPECT_FALSE(fs::exists(In("metrics.json")));
  EXPECT_FALSE(fs::is_symlink(part)) << "half of it stays";
}

TEST_F(FullDiskTest, ATraceNamesItsFile) {
  FleetConfig fleet;
  fleet.arms.resize(2);
  fleet.arms[0].id = 3;
  fleet.arms[1].id = 4;
  const std::string trace = Full("arm_4.csv");
  TraceWriter writer(temp_.path().string(), fleet);
  ASSERT_TRUE(writer.ok()) << writer.error();
  TraceRow row;
  row.zeta = Zeta::Zero(PlanarArm::kTaskDim);
  for (int k = 0; k < 1000; ++k) {
    writer.Arm(0, row);
    writer.Arm(1, row);
  }
  EXPECT_FALSE(writer.Close());
  EXPECT_EQ(writer.error(), "cannot write " + trace + ": No space left on device");
}

TEST_F(FullDiskTest, ATraceThatFitsIsFine) {
  FleetConfig fleet;
  fleet.arms.resize(1);
  fleet.arms[0].id = 3;
  TraceWriter writer(temp_.path().string(), fleet);
  TraceRow row;
  row.zeta = Zeta::Zero(PlanarArm::kTaskDim);
  writer.Arm(0, row);
  EXPECT_TRUE(writer.Close()) << writer.error();
}

}  // namespace
}  // namespace armada
