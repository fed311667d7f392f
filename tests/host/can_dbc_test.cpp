// DBC files against canmatrix, with frames of our masters and emulated drives.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "firmware/core/named_enum.h"
#include "host/can/bus_messages.h"
#include "host/can/dbc.h"
#include "tests/hil/command_output.h"
#include "tests/host/can_bench.h"

namespace armada {
namespace {

std::string FileText(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<JointDriveConfig> TwoJoints(DriveProfile profile) {
  std::vector<JointDriveConfig> joints;
  for (const int node : {1, 2}) joints.push_back({.profile = profile, .node_id = node});
  return joints;
}

/// Frames for can_dbc_judge.py.
std::string JudgeLine(const CanFrame& frame) {
  std::ostringstream text;
  text << std::hex << frame.id << (frame.extended ? " x" : " -") << (frame.fd ? " f " : " - ");
  for (size_t i = 0; i < frame.length; ++i) {
    constexpr char kHex[] = "0123456789abcdef";
    text << kHex[frame.data[i] >> 4] << kHex[frame.data[i] & 15];
  }
  if (frame.length == 0) text << '-';
  return text.str();
}

struct Verdict {
  std::string name;
  bool fd = false;
  std::map<std::string, double> signals;
};

Verdict Parse(const std::string& line) {
  std::istringstream words(line);
  Verdict verdict;
  std::string word;
  words >> verdict.name >> word;
  verdict.fd = word == "f";
  while (words >> word) {
    const size_t sign = word.find('=');
    verdict.signals[word.substr(0, sign)] = std::stod(word.substr(sign + 1));
  }
  return verdict;
}

class DbcOf : public testing::TestWithParam<DriveProfile> {};

TEST_P(DbcOf, TheDocumentationIsWhatTheCommandMakes) {
  const std::string name(NameOf(GetParam()));
  const Dbc dbc = MakeDbc(name + ", default ranges", MessagesOfBus(TwoJoints(GetParam())));
  EXPECT_TRUE(FileText(std::string(ARMADA_SOURCE_DIR) + "/docs/can/" + name + ".dbc") == dbc.text)
      << "docs/can/" << name << ".dbc is not what the tables give: armada can dbc --profile " << name;
}

TEST_P(DbcOf, CanmatrixReadsTheValuesThatWeSentAndReceived) {
  std::vector<JointDriveConfig> joints = TwoJoints(GetParam());
  for (JointDriveConfig& joint : joints) {
    joint.gear_ratio = 10.0;
    joint.torque_limit_Nm = 50.0;
  }
  const std::vector<BusMessage> messages = MessagesOfBus(joints);
  const Dbc dbc = MakeDbc("test", messages);
  const std::set<std::string> dropped(dbc.dropped.begin(), dbc.dropped.end());

  std::string pattern = testing::TempDir() + "can_dbc_XXXXXX";
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  std::ofstream(pattern + "/bus.dbc") << dbc.text;
  std::vector<CanFrame> frames;
  {
    std::ofstream file(pattern + "/frames");
    for (const CanFrame& frame : Conversation(joints)) {
      if (frame.remote) continue;
      frames.push_back(frame);
      file << JudgeLine(frame) << '\n';
    }
  }
  const auto lines = OutputLines(std::string(ARMADA_PYTHON) + " " + ARMADA_CAN_DBC_JUDGE + " " + pattern +
                                 "/bus.dbc <" + pattern + "/frames");
  std::filesystem::remove_all(pattern);
  ASSERT_EQ(lines.size(), frames.size() + 1) << "canmatrix (Debian: python3-canmatrix) did not read it";

  std::set<std::string> seen;
  size_t compared = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    const BusMessage* const found = FindMessage(messages, frames[i]);
    ASSERT_NE(found, nullptr) << JudgeLine(frames[i]);
    const std::string full_name =
        (found->owner.empty() ? "" : found->owner + "_") + std::string(found->message.name);
    seen.insert(found->message.name);
    if (dropped.contains(full_name)) continue;
    const Verdict verdict = Parse(lines[i + 1]);
    ASSERT_NE(verdict.name, "none") << full_name;
    EXPECT_EQ(verdict.fd, frames[i].fd);
    for (const CanSignal& signal : found->message.signals) {
      auto at = verdict.signals.find(full_name + "_" + signal.name);
      if (at == verdict.signals.end()) at = verdict.signals.find(signal.name);
      ASSERT_NE(at, verdict.signals.end()) << full_name << " " << signal.name << ": " << lines[i + 1];
      const double ours = GetPhysical(frames[i], signal);
      if (std::isnan(ours)) {
        EXPECT_TRUE(std::isnan(at->second)) << full_name << " " << signal.name;
      } else {
        ASSERT_NEAR(at->second, ours, 1e-9 * std::max(1.0, std::abs(ours)))
            << full_name << " " << signal.name;
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 400u);
  EXPECT_GE(seen.size(), 4u);  // commands, states and the bring-up were among them
}

INSTANTIATE_TEST_SUITE_P(Profiles, DbcOf,
                         testing::Values(DriveProfile::kODriveCanSimple, DriveProfile::kODriveCanSimpleV05,
                                         DriveProfile::kMiniCheetah, DriveProfile::kCubeMars,
                                         DriveProfile::kDamiao, DriveProfile::kCia402, DriveProfile::kMoteus),
                         [](const auto& test) { return std::string(NameOf(test.param)); });

}  // namespace
}  // namespace armada
