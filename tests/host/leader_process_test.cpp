#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "firmware/app/realtime.h"
#include "firmware/clock/machine_clock.h"
#include "firmware/link/channels.h"
#include "firmware/link/lcm_endpoint.h"
#include "firmware/link/messages.h"
#include "hil/leader_path.h"
#include "hil/scenario_file.h"
#include "host/process_group.h"
#include "tests/link/private_network_fixture.h"

namespace armada {
namespace {

const std::string kScenario = ARMADA_SOURCE_DIR "/hil/scenarios/paper.toml";
constexpr std::chrono::seconds kPatience{30};

class LeaderProcess : public PrivateNetworkTest {
 protected:
  void SetUp() override {
    PrivateNetworkTest::SetUp();
    std::string error;
    listener_ = LcmEndpoint::Open({}, MachineClock::Get(), &error);
    ASSERT_NE(listener_, nullptr) << error;
  }

  void Start(std::vector<std::string> arguments, const std::vector<std::string>& launcher = {}) {
    std::vector<std::string> argv = launcher;
    argv.push_back(ARMADA_LEADER);
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    std::string error;
    ASSERT_TRUE(group_.Start({"leader", argv, {}, log_path_}, &error)) << error;
  }

  int ExitCode() {
    const auto ended = group_.Poll(kPatience);
    return ended && WIFEXITED(ended->wait_status) ? WEXITSTATUS(ended->wait_status) : -1;
  }

  std::string Log() const {
    std::stringstream text;
    text << std::ifstream(log_path_).rdbuf();
    return text.str();
  }

  // Takes what has come; waits for the first of it.
  std::vector<leader_t> Receive() {
    pollfd input{listener_->descriptor(), POLLIN, 0};
    poll(&input, 1, static_cast<int>(std::chrono::milliseconds(kPatience).count()));
    return ReceiveNow();
  }

  std::vector<leader_t> ReceiveNow() {
    std::vector<leader_t> messages;
    listener_->Drain([&](const LcmMessage& message) {
      leader_t leader{};
      EXPECT_EQ(message.channel, kLeaderChannel);
      EXPECT_TRUE(Decode(message.payload, &leader));
      messages.push_back(leader);
    });
    return messages;
  }

  std::string log_path_ = ::testing::TempDir() + "armada_leader_" + std::to_string(getpid()) + ".log";
  std::unique_ptr<LcmEndpoint> listener_;
  ProcessGroup group_;
};

void ExpectOnPath(const LeaderPath& path, const leader_t& message) {
  const Zeta zeta = path.At(message.path_time_s);
  EXPECT_EQ(message.task_dim, 2);
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(message.x_m[c], zeta.x_m[c]);
    EXPECT_EQ(message.v_m_s[c], zeta.v_m_s[c]);
    EXPECT_EQ(message.a_m_s2[c], zeta.a_m_s2[c]);
    EXPECT_EQ(message.jerk_m_s3[c], path.Jerk(message.path_time_s)[c]);
  }
}

TEST_F(LeaderProcess, SendsTheExactStateOfEachGridTimeUntilToldToStop) {
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(kScenario, {}, &errors);
  ASSERT_TRUE(scenario);
  const LeaderPath path(scenario->leader);
  const int64_t epoch_ns = MonotonicNow() - 3'141'592'653;
  Start({kScenario, "--epoch-ns", std::to_string(epoch_ns)});

  std::vector<leader_t> messages;
  while (messages.size() < 5) {
    const auto more = Receive();
    ASSERT_FALSE(more.empty()) << Log();
    messages.insert(messages.end(), more.begin(), more.end());
  }
  const auto ended = group_.StopAll(kPatience);
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_TRUE(ended[0].Succeeded()) << ended[0].Describe();

  for (size_t i = 0; i < messages.size(); ++i) {
    const int64_t since_epoch_ns = messages[i].stamp_ns - epoch_ns;
    EXPECT_EQ(messages[i].sequence, static_cast<int64_t>(i) + 1);
    EXPECT_EQ(since_epoch_ns % 10'000'000, 0) << "off the grid of 100 Hz";
    EXPECT_EQ(messages[i].path_time_s, static_cast<double>(since_epoch_ns) / 1e9);
    if (i > 0) {
      EXPECT_GT(messages[i].stamp_ns, messages[i - 1].stamp_ns);
    }
    ExpectOnPath(path, messages[i]);
  }
}

TEST_F(LeaderProcess, EndsByItselfAfterTheTimeGiven) {
  Start({kScenario, "--seconds", "0.2", "--set", "leader.rate_hz=50"});
  EXPECT_EQ(ExitCode(), 0) << Log();
  const auto messages = ReceiveNow();
  ASSERT_FALSE(messages.empty());
  EXPECT_LT(messages.back().path_time_s, 0.2);
}

TEST_F(LeaderProcess, WithoutAMulticastRouteItSaysSoAndSendsNothing) {
  Start({kScenario}, {"/usr/bin/unshare", "-n"});
  EXPECT_EQ(ExitCode(), 1);
  EXPECT_NE(Log().find("route"), std::string::npos) << Log();
  EXPECT_TRUE(ReceiveNow().empty());
}

TEST_F(LeaderProcess, BadConfigurationAndBadUsageHaveTheirExitCodes) {
  Start({kScenario, "--set", "leader.rate_hz=0"});
  EXPECT_EQ(ExitCode(), 78);
  EXPECT_NE(Log().find("leader.rate_hz"), std::string::npos) << Log();
  Start({kScenario, "--seconds", "soon"});
  EXPECT_EQ(ExitCode(), 2);
  Start({ARMADA_SOURCE_DIR "/hil/scenarios/leaderless.toml"});
  EXPECT_EQ(ExitCode(), 2);
  EXPECT_NE(Log().find("has no leader"), std::string::npos) << Log();
  EXPECT_TRUE(ReceiveNow().empty());
}

}  // namespace
}  // namespace armada
