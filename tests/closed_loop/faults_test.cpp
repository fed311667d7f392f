// Faults of a scenario in virtual time: what they do, and that they do nothing else.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/sim/link_faults.h"
#include "tests/closed_loop/simulate.h"

namespace armada {
namespace {

const std::vector<std::string> kShort = {"seconds=4.0", "window_start_s=2.0"};

std::vector<std::string> With(const std::string& fault) {
  std::vector<std::string> sets = kShort;
  sets.push_back("fault=[" + fault + "]");
  return sets;
}

std::string Figures(const RunMetrics& metrics) {
  return ToJson(metrics).dump();
}

const ArmMetrics& Arm(const RunMetrics& metrics, int id) {
  return metrics.arms[static_cast<size_t>(id - 1)];
}

// Every place where a fault can act is there, and lets everything through as it is.
TEST(Faults, ThatNeverComeChangeNotABit) {
  std::string all;
  const auto add = [&](const std::string& fault) {
    all += (all.empty() ? "{at_s=1e5," : ",{at_s=1e5,") + fault + "}";
  };
  for (const char* signal : {"position", "velocity", "current"}) {
    add("arm=2,kind=\"drive\",way=\"stuck\",signal=\"" + std::string(signal) + "\"");
    add("arm=3,kind=\"drive\",way=\"delayed\",value=0.05,signal=\"" + std::string(signal) + "\"");
  }
  add("arm=2,kind=\"drive\",way=\"off\",signal=\"status\"");
  for (const char* kind : {"drive_error", "bus_off", "error_passive", "bus_down", "queue_full",
                           "controller_dies", "controller_stops", "partition", "reorder"}) {
    add("arm=1,kind=\"" + std::string(kind) + "\"");
  }
  add("arm=1,kind=\"controller_restarts\",until_s=2e5");
  for (const char* kind : {"bus_loss", "bus_delay", "slow_tick", "link_loss", "replay", "forge"}) {
    add("arm=1,kind=\"" + std::string(kind) + "\",value=0.1");
  }
  add("arm=1,kind=\"junk\",value=1000");
  add("kind=\"leader_dies\"");
  add("kind=\"leader_nonfinite\"");
  EXPECT_EQ(Figures(Simulate("paper", 3, With(all))), Figures(Simulate("paper", 3, kShort)));
}

TEST(Faults, AreTheSameForTheSameSeed) {
  const auto run = [](uint64_t seed) {
    return Figures(
        Simulate("paper", seed,
                 With("{kind=\"bus_loss\",at_s=1.0,arm=2,value=0.05},"
                      "{kind=\"link_loss\",at_s=1.0,arm=1,value=0.3},"
                      "{kind=\"drive\",at_s=1.0,arm=3,signal=\"velocity\",way=\"garbage\",value=0.1}")));
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5), run(6));
}

// What is not believed has no effect at all.
TEST(Faults, MessagesOfNobodyChangeNotABit) {
  const std::string plain = Figures(Simulate("paper", 3, kShort));
  for (const char* fault :
       {"{kind=\"forge\",at_s=1.0,arm=1,value=0.05}", "{kind=\"forge\",at_s=1.0,value=0.05}",
        "{kind=\"replay\",at_s=1.0,arm=3,value=0.5}", "{kind=\"replay\",at_s=1.0,value=0.02}",
        "{kind=\"junk\",at_s=1.0,arm=1,value=5000}", "{kind=\"junk\",at_s=1.0,value=5000}"}) {
    EXPECT_EQ(Figures(Simulate("paper", 3, With(fault))), plain) << fault;
  }
}

TEST(Faults, OfTheLeaderThatLastShortlyAreRiddenOut) {
  for (const char* fault : {"{kind=\"leader_stops\",at_s=2.5,until_s=2.55}",
                            "{kind=\"leader_jumps\",at_s=2.5,until_s=2.53,value=0.2}",
                            "{kind=\"leader_nonfinite\",at_s=2.5,until_s=2.53}"}) {
    const RunMetrics metrics = Simulate("benign", 1, With(fault));
    EXPECT_TRUE(metrics.ok) << fault;
    EXPECT_NE(Figures(metrics), Figures(Simulate("benign", 1, kShort))) << fault;
  }
}

// The arm falls; those that hear another node as well do not notice, and nobody judges it.
TEST(Faults, ADeadControllerTakesItsArmAloneOut) {
  for (const char* fault :
       {"{kind=\"controller_dies\",at_s=2.5,arm=1}", "{kind=\"bus_off\",at_s=2.5,arm=1}",
        "{kind=\"bus_down\",at_s=2.5,until_s=2.6,arm=1}", "{kind=\"queue_full\",at_s=2.5,until_s=2.6,arm=1}",
        "{kind=\"controller_stops\",at_s=2.5,until_s=2.6,arm=1}",
        "{kind=\"drive_error\",at_s=2.5,arm=1,joint=2}"}) {
    std::vector<std::string> sets = With(fault);
    EXPECT_FALSE(Simulate("benign", 1, sets).ok) << fault;
    sets.push_back("criterion.excused=[1]");
    const RunMetrics metrics = Simulate("benign", 1, sets);
    EXPECT_TRUE(metrics.ok) << fault;
    EXPECT_GT(Arm(metrics, 1).max_m, 0.1) << fault;
  }
}

// Arms 2 and 4 hear arm 1, and arm 3 as well.
TEST(Faults, ADeadControllerStopsThoseThatHearItWhereTheFleetHoldsTogether) {
  std::vector<std::string> sets = With("{kind=\"controller_dies\",at_s=2.5,arm=1}");
  for (const char* policy : {"carry_on", "hold"}) {
    sets.push_back("control.supervisor.fleet_stop=\"" + std::string(policy) + "\"");
    const RunMetrics metrics = Simulate("benign", 1, sets);
    for (const int id : {2, 4})
      EXPECT_EQ(Arm(metrics, id).state, policy == std::string("hold") ? "HOLD" : "RUN");
    for (const int id : {3, 5, 6, 7}) EXPECT_EQ(Arm(metrics, id).state, "RUN") << policy << id;
    sets.pop_back();
  }
}

TEST(Faults, AControllerThatMissesATickTracksOn) {
  const RunMetrics metrics =
      Simulate("benign", 1, With("{kind=\"controller_stops\",at_s=2.5,until_s=2.51,arm=1}"));
  EXPECT_TRUE(metrics.ok);
  EXPECT_NE(Figures(metrics), Figures(Simulate("benign", 1, kShort)));
}

// Nobody hears arm 2.
TEST(Faults, AControllerThatIsRestartedIsItsOwnArmsConcern) {
  const RunMetrics plain = Simulate("benign", 1, kShort);
  const RunMetrics metrics =
      Simulate("benign", 1, With("{kind=\"controller_restarts\",at_s=2.2,until_s=2.4,arm=2}"));
  EXPECT_GT(Arm(metrics, 2).max_m, 0.1);
  for (const int id : {1, 3, 4, 5, 6, 7}) EXPECT_EQ(Arm(metrics, id).rms_m, Arm(plain, id).rms_m) << id;
}

// The tick waits for its samples: a millisecond each way is within timing.feedback_timeout_s.
TEST(Faults, ASlowBusOrASlowTickMakesTheTorqueLate) {
  for (const char* fault : {"{kind=\"bus_delay\",at_s=1.0,arm=2,value=0.001}",
                            "{kind=\"slow_tick\",at_s=1.0,arm=2,value=0.003}"}) {
    const RunMetrics metrics = Simulate("benign", 1, With(fault));
    EXPECT_TRUE(Arm(metrics, 2).faults.empty()) << fault;
    EXPECT_GT(Arm(metrics, 2).rms_m, 1.2 * Arm(Simulate("benign", 1, kShort), 2).rms_m) << fault;
    EXPECT_LT(Arm(metrics, 2).max_m, 0.1) << fault;
  }
}

TEST(Faults, ASealedFleetIsOneWhoseSealsAreTried) {
  EXPECT_FALSE(NeedsSeals(ScenarioNamed("paper").faults));
  EXPECT_FALSE(NeedsSeals(ScenarioNamed("faults/junk").faults));
  EXPECT_TRUE(NeedsSeals(ScenarioNamed("faults/forge").faults));
  EXPECT_TRUE(NeedsSeals(ScenarioNamed("faults/replay").faults));
}

}  // namespace
}  // namespace armada
