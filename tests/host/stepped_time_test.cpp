// Stepped time with real processes on a real network: the order of what happens, its independence of the
// machine, and what is said when a program dies or hangs.

#include "host/run/stepped_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "firmware/can/open_bus.h"
#include "firmware/clock/machine_clock.h"
#include "tests/link/private_network_fixture.h"
#include "tests/support/numbers.h"
#include "tests/support/temp_dir.h"

namespace armada {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;

class SteppedTimeTest : public PrivateNetworkTest {
 protected:
  void Begin(double pace = 0.0) {
    time_ = SteppedTime::Create(pace, &error_);
    ASSERT_NE(time_, nullptr) << error_;
  }
  /// A program, by its role as stepped_actor has it.
  void Start(const std::string& name, std::vector<std::string> role) {
    std::vector<std::string> argv = {ARMADA_STEPPED_ACTOR, Log(name)};
    argv.insert(argv.end(), role.begin(), role.end());
    const auto of_time = time_->ArgumentsFor(name);
    argv.insert(argv.end(), of_time.begin(), of_time.end());
    ASSERT_TRUE(
        group_.Start({name, argv, {}, folder_.path() / (name + ".txt"), time_->descriptor()}, &error_))
        << error_;
  }
  void Await() { ASSERT_TRUE(time_->AwaitPrograms(&group_, &error_)) << error_; }
  std::string Log(const std::string& name) const { return folder_.path() / (name + ".log"); }
  std::string LogOf(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(Log(name)).rdbuf();
    return text.str();
  }
  /// Lets time pass in steps of 1 ms until `until_ms`; the programs that ended meanwhile.
  std::vector<ProcessExit> PassUntil(int64_t until_ms) {
    std::vector<ProcessExit> ended;
    const int64_t begin_ns = time_->Now();
    for (int64_t t_ms = 1; t_ms <= until_ms && time_->trouble().empty(); ++t_ms) {
      while (time_->Now() < begin_ns + t_ms * kMs && time_->trouble().empty()) {
        if (auto one = time_->Pass(&group_, {}, begin_ns + t_ms * kMs)) {
          ended.push_back(*one);
          if (!one->Succeeded()) return ended;
        }
      }
    }
    return ended;
  }

  std::string error_;
  TempDir folder_;
  std::unique_ptr<SteppedTime> time_;
  ProcessGroup group_;
};

TEST_F(SteppedTimeTest, WhatIsSentArrivesInTheSameInstantWhoeverReadsWhen) {
  Begin();
  Start("answerer", {"answer", "50"});
  Start("speaker", {"speak", "10", "3"});
  Start("reader", {"read", "25", "50"});
  Await();
  const auto ended = PassUntil(60);
  ASSERT_EQ(ended.size(), 3u);
  EXPECT_EQ(LogOf("speaker"), "10.000 spoke 0 10.000\n20.000 spoke 1 20.000\n30.000 spoke 2 30.000\n");
  EXPECT_EQ(LogOf("answerer"),
            "10.000 answered 0 10.000\n20.000 answered 1 20.000\n30.000 answered 2 30.000\n");
  // Read later, each has the time at which it came.
  EXPECT_EQ(LogOf("reader"),
            "25.000 read 0 10.000\n25.000 read 100 10.000\n25.000 read 1 20.000\n25.000 read 101 20.000\n"
            "50.000 read 2 30.000\n50.000 read 102 30.000\n");
  EXPECT_EQ(time_->lost(), 0u);
}

// Programs whose time has come run before those that a message wakes: the speaker of slot 2 has spoken, and
// the reader of slot 3 has read, before the answerer of slot 1 gets the word.
TEST_F(SteppedTimeTest, InOneInstantDeadlinesComeBeforeMessages) {
  Begin();
  Start("answerer", {"answer", "15"});
  Start("speaker", {"speak", "10", "1"});
  Start("reader", {"read", "10", "20"});
  Await();
  PassUntil(30);
  EXPECT_EQ(LogOf("reader"), "10.000 read 0 10.000\n20.000 read 100 10.000\n");
}

TEST_F(SteppedTimeTest, ProgramsThatAreStoppedByTheMachineChangeNothing) {
  std::vector<std::string> logs;
  for (const bool disturbed : {false, true}) {
    SCOPED_TRACE(disturbed);
    for (const char* name : {"answerer", "speaker", "reader"}) std::filesystem::remove(Log(name));
    Begin();
    Start("answerer", {"answer", "300"});
    Start("speaker", {"speak", "3", "90"});
    Start("reader", {"read", "7", "300"});
    Await();
    std::jthread disturber;
    if (disturbed) {
      disturber = std::jthread([&](const std::stop_token& stop) {
        std::mt19937 random(1);
        const std::array<const char*, 3> names = {"answerer", "speaker", "reader"};
        while (!stop.stop_requested()) {
          const char* const name = names[random() % names.size()];
          group_.Signal(name, SIGSTOP);
          std::this_thread::sleep_for(milliseconds(random() % 20));
          group_.Signal(name, SIGCONT);
        }
      });
    }
    for (const int64_t begin_ns = time_->Now(); time_->Now() < begin_ns + 250 * kMs;) {
      time_->Pass(&group_, {}, time_->Now() + 5 * kMs);
    }
    if (disturbed) disturber = {};
    PassUntil(100);
    logs.push_back(LogOf("answerer") + LogOf("speaker") + LogOf("reader"));
    time_.reset();
  }
  EXPECT_EQ(std::count(logs[0].begin(), logs[0].end(), '\n'), 90 + 90 + 180);
  EXPECT_EQ(logs[0], logs[1]);
}

TEST_F(SteppedTimeTest, AProgramWithoutTurnsFindsLaterWhatHasCome) {
  Begin();
  Start("answerer", {"answer", "100"});
  Start("speaker", {"speak", "10", "3"});
  Await();
  PassUntil(15);
  ASSERT_TRUE(time_->Suspend("answerer", true));
  PassUntil(10);
  ASSERT_TRUE(time_->Suspend("answerer", false));
  PassUntil(100);
  EXPECT_EQ(LogOf("answerer"),
            "10.000 answered 0 10.000\n25.000 answered 1 20.000\n30.000 answered 2 30.000\n");
}

// A full socket keeps what came first, however much was sent since.
TEST_F(SteppedTimeTest, WhatWaitedLongKeepsItsTime) {
  Begin();
  Start("speaker", {"speak", "0.25", "3000"});
  Start("reader", {"read", "800", "800"});
  Await();
  for (const ProcessExit& ended : PassUntil(900)) EXPECT_TRUE(ended.Succeeded()) << ended.Describe();
  const std::string log = LogOf("reader");
  EXPECT_THAT(log, StartsWith("800.000 read 0 0.250\n800.000 read 1 0.500\n"));
  EXPECT_THAT(log, HasSubstr("\n800.000 read 99 25.000\n"));
  EXPECT_GT(time_->dropped(), 1u);
  EXPECT_EQ(time_->lost() + time_->forgotten(), 0u);
}

TEST_F(SteppedTimeTest, AProgramThatIsKilledOnOrderLeavesTheOthersAlone) {
  Begin();
  Start("answerer", {"answer", "50"});
  Start("speaker", {"speak", "10", "3"});
  Await();
  PassUntil(15);
  ASSERT_TRUE(time_->Kill(&group_, "answerer"));
  const auto killed = time_->Pass(&group_, {}, time_->Now() + kMs);
  ASSERT_TRUE(killed.has_value());
  EXPECT_EQ(killed->name, "answerer");
  PassUntil(30);
  EXPECT_EQ(LogOf("answerer"), "10.000 answered 0 10.000\n");
  EXPECT_THAT(LogOf("speaker"), HasSubstr("30.000 spoke 2"));
}

TEST_F(SteppedTimeTest, AProgramThatStartsAnewJoinsAtThatTime) {
  Begin();
  Start("answerer", {"answer", "50"});
  Start("speaker", {"speak", "10", "3"});
  Await();
  PassUntil(15);
  time_->Kill(&group_, "answerer");
  time_->Pass(&group_, {}, time_->Now() + kMs);
  Start("answerer", {"answer", "50"});
  Await();
  PassUntil(100);
  EXPECT_EQ(LogOf("answerer"),
            "10.000 answered 0 10.000\n5.000 answered 1 5.000\n15.000 answered 2 15.000\n");
}

TEST_F(SteppedTimeTest, OneMayStartAnewWhileAnotherThatWasKilledHasNotEnded) {
  Begin();
  Start("answerer", {"answer", "50"});
  Start("speaker", {"speak", "10", "3"});
  Await();
  PassUntil(15);
  time_->Kill(&group_, "answerer");
  time_->Pass(&group_, {}, time_->Now() + kMs);
  time_->Kill(&group_, "speaker");
  Start("answerer", {"answer", "50"});
  Await();
  const auto ended = time_->Pass(&group_, {}, time_->Now() + kMs);
  ASSERT_TRUE(ended.has_value());
  EXPECT_EQ(ended->name, "speaker");
}

TEST_F(SteppedTimeTest, WhoDiesIsNamedWithinASecond) {
  Begin();
  Start("speaker", {"speak", "10", "100"});
  Start("victim", {"die", "25"});
  Await();
  const int64_t begin_ns = MachineClock::Get()->Now();
  const auto ended = PassUntil(1000);
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_THAT(ended[0].Describe(), HasSubstr("victim"));
  EXPECT_THAT(ended[0].Describe(), HasSubstr("SIGABRT"));
  EXPECT_EQ(time_->Now() % (1000 * kMs), 25 * kMs) << "time stands where it died";
  EXPECT_LT(MachineClock::Get()->Now() - begin_ns, 30'000 * kMs);
}

TEST_F(SteppedTimeTest, WhoHangsIsNamed) {
  Begin();
  Start("speaker", {"speak", "10", "100"});
  Start("dreamer", {"hang", "25"});
  Await();
  PassUntil(1000);
  EXPECT_THAT(time_->trouble(), HasSubstr("dreamer (pid "));
  EXPECT_THAT(time_->trouble(), HasSubstr("hangs: its turn at 0.025 s of stepped time"));
}

// As the machine does that steers packets to other processors: what was sent is not there yet.
TEST_F(SteppedTimeTest, AMessageThatNeverComesIsNoticed) {
  Begin();
  const auto bus = OpenBus("udp:239.74.163.77:43177", {}, time_.get(), &error_);
  ASSERT_NE(bus, nullptr) << error_;
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(43177);
  group.sin_addr.s_addr = htonl(0xEF4AA34D);
  time_->Sent(group);  // it was not
  CanFrame frame;
  EXPECT_EQ(bus->Receive(0, &frame), BusStatus::kTimeout);
  EXPECT_EQ(time_->lost(), 1u);
  EXPECT_EQ(bus->Receive(0, &frame), BusStatus::kTimeout);
  EXPECT_EQ(time_->lost(), 1u) << "once";
}

TEST_F(SteppedTimeTest, MessagesOfStrangersAreCountedAndTheOthersKeepTheirTimes) {
  Begin();
  Start("speaker", {"speak", "10", "3"});
  Start("reader", {"read", "25", "50"});
  Await();
  const auto stranger = OpenBus("udp:239.74.163.77:43177", {}, MachineClock::Get(), &error_);
  ASSERT_NE(stranger, nullptr) << error_;
  PassUntil(26);
  CanFrame frame;
  frame.id = 77;
  ASSERT_EQ(stranger->Send(frame), BusStatus::kOk);
  PassUntil(30);
  EXPECT_EQ(LogOf("reader"),
            "25.000 read 0 10.000\n25.000 read 1 20.000\n50.000 read 77 30.000\n50.000 read 2 50.000\n");
  EXPECT_EQ(time_->strangers(), 1u);
  EXPECT_EQ(time_->lost(), 0u);
}

TEST_F(SteppedTimeTest, PacedItIsNeverAheadOfTheMachine) {
  Begin(2.0);
  Start("speaker", {"speak", "10", "10"});
  Await();
  const int64_t begin_ns = MachineClock::Get()->Now();
  PassUntil(100);
  EXPECT_GE(MachineClock::Get()->Now() - begin_ns, 49 * kMs);
}

TEST_F(SteppedTimeTest, ReleasedProgramsGoOnByThemselves) {
  Begin();
  Start("speaker", {"speak", "10", "10"});
  Await();
  PassUntil(15);
  time_->Release();
  const auto ended = group_.Poll(milliseconds(20'000));
  ASSERT_TRUE(ended.has_value());
  EXPECT_TRUE(ended->Succeeded()) << ended->Describe();
}

}  // namespace
}  // namespace armada
