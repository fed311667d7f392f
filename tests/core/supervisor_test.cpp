#include "firmware/core/supervisor.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/core/paper_setting.h"

namespace armada {
namespace {

using State = ControllerState;

SupervisorInput Quiet() {
  SupervisorInput in;
  in.drives_ready = in.drives_enabled = true;
  in.samples_valid = in.samples_good = in.neighbours_good = in.synced = true;
  return in;
}

SupervisorInput With(Cause cause) {
  SupervisorInput in = Quiet();
  in.causes.Add(cause);
  return in;
}

SupervisorInput Asking(Request request) {
  SupervisorInput in = Quiet();
  in.request = request;
  return in;
}

class Supervised : public testing::Test {
 protected:
  State Step(const SupervisorInput& in) { return supervisor_.Step(in, kPeriod_s); }
  State StepFor(const SupervisorInput& in, double seconds) {
    for (double t_s = 0.0; t_s < seconds - 1e-9; t_s += kPeriod_s) Step(in);
    return supervisor_.state();
  }
  /// From the start to `state`, the way an operator takes, or by a cause.
  void Reach(State state) {
    supervisor_ = Supervisor(config_, StartMode::kMonitor);
    SupervisorInput off = Quiet();
    off.drives_enabled = false;
    if (state == State::kInit) return;
    Step(off);
    if (state == State::kMonitor) return;
    off.request = Request::kArm;
    Step(off);
    if (state == State::kArming) return;
    Step(Quiet());
    if (state == State::kHold) return;
    StepFor(Quiet(), config_.hold_clear_s);
    Step(Asking(Request::kStart));
    if (state == State::kRun) return;
    if (state == State::kDegraded) Step(With(Cause::kSampleLate));
    if (state == State::kSafeStop) Step(With(Cause::kJointLimit));
    if (state == State::kFault) Step(With(Cause::kBusOff));
  }

  SupervisorConfig config_;
  Supervisor supervisor_{config_, StartMode::kMonitor};
};

TEST_F(Supervised, AnOperatorTakesItFromInitToRunAndBack) {
  SupervisorInput nothing;
  nothing.speed_rad_s = 0.0;
  EXPECT_EQ(StepFor(nothing, 1.0), State::kInit);
  for (const State state : {State::kMonitor, State::kArming, State::kHold, State::kRun}) {
    Reach(state);
    ASSERT_EQ(supervisor_.state(), state) << NameOf(state);
  }
  EXPECT_EQ(Step(Asking(Request::kHold)), State::kHold);
  EXPECT_EQ(supervisor_.cause(), Cause::kOperatorHold);
  EXPECT_EQ(Step(Asking(Request::kReset)), State::kInit);
}

TEST_F(Supervised, TheRulesAreInTheOrderOfTheCauses) {
  for (int i = 0; i < kCauses; ++i) EXPECT_EQ(static_cast<int>(kCauseRules[static_cast<size_t>(i)].cause), i);
}

TEST_F(Supervised, EveryCauseHasItsReactionFromEveryStateThatFollows) {
  for (const State from : {State::kRun, State::kDegraded}) {
    for (const CauseRule& rule : kCauseRules) {
      Reach(from);
      const State expected = rule.cause == Cause::kArmingTimeout ? State::kFault : rule.reaction;
      EXPECT_EQ(Step(With(rule.cause)), expected) << rule.name;
      EXPECT_EQ(supervisor_.cause(), rule.cause) << rule.name;
    }
  }
}

TEST_F(Supervised, TheWorstOfSeveralCausesWins) {
  for (const CauseRule& a : kCauseRules) {
    for (const CauseRule& b : kCauseRules) {
      Reach(State::kRun);
      SupervisorInput in = With(a.cause);
      in.causes.Add(b.cause);
      EXPECT_EQ(Step(in), std::max(a.reaction, b.reaction)) << a.name << ", " << b.name;
    }
  }
}

// Whatever happens, for however long: only an operator's arm and start lead to torque and to motion.
TEST_F(Supervised, NothingReArmsByItself) {
  for (const State from : {State::kInit, State::kMonitor, State::kHold, State::kSafeStop, State::kFault}) {
    for (const CauseRule& rule : kCauseRules) {
      Reach(from);
      Step(With(rule.cause));
      for (const bool enabled : {true, false}) {
        SupervisorInput quiet = Quiet();
        quiet.drives_enabled = enabled;
        const State at_last = StepFor(quiet, 3.0);
        EXPECT_FALSE(Follows(at_last)) << NameOf(from) << ", " << rule.name;
        EXPECT_TRUE(GivesTorque(from) || !GivesTorque(at_last)) << NameOf(from) << ", " << rule.name;
      }
    }
  }
}

TEST_F(Supervised, WithoutTorqueThereIsNoCauseButAnEstop) {
  for (const State from : {State::kInit, State::kMonitor}) {
    for (const CauseRule& rule : kCauseRules) {
      Reach(from);
      SupervisorInput in = With(rule.cause);
      in.drives_enabled = false;
      EXPECT_LE(Step(in), State::kMonitor) << rule.name;
    }
    Reach(from);
    EXPECT_EQ(Step(Asking(Request::kEstop)), State::kFault);
  }
}

TEST_F(Supervised, AnEstopNeedsNoStateAndIsNeverRefused) {
  for (int i = 0; i < kControllerStates; ++i) {
    Reach(static_cast<State>(i));
    SupervisorInput in;  // nothing is good
    in.speed_rad_s = 10.0;
    in.request = Request::kEstop;
    const State state = Step(in);
    EXPECT_EQ(supervisor_.refusals(), 0u);
    EXPECT_EQ(state, GivesTorque(static_cast<State>(i)) ? State::kSafeStop : State::kFault)
        << NameOf(static_cast<State>(i));
  }
}

TEST_F(Supervised, DegradedEndsByItselfOnceItsCauseIsGone) {
  Reach(State::kDegraded);
  EXPECT_TRUE(supervisor_.halves_gains());
  EXPECT_EQ(StepFor(Quiet(), config_.degraded_clear_s - kPeriod_s), State::kDegraded);
  EXPECT_EQ(Step(Quiet()), State::kRun);
  EXPECT_FALSE(supervisor_.halves_gains());
  EXPECT_EQ(supervisor_.cause(), Cause::kNone);
}

TEST_F(Supervised, ASafeStopEndsInFaultAtRestOrAfterItsTime) {
  Reach(State::kSafeStop);
  SupervisorInput moving = Quiet();
  moving.speed_rad_s = 1.0;
  EXPECT_EQ(StepFor(moving, config_.safe_stop_max_s - 2 * kPeriod_s), State::kSafeStop);
  EXPECT_EQ(StepFor(moving, 3 * kPeriod_s), State::kFault);
  EXPECT_EQ(supervisor_.cause(), Cause::kJointLimit) << "why it stopped, not that it did";

  Reach(State::kSafeStop);
  EXPECT_EQ(StepFor(Quiet(), config_.safe_stop_rest_s + kPeriod_s), State::kFault);
}

TEST_F(Supervised, HoldIsLeftOnlyOnceTheCauseHasBeenGoneForAWhile) {
  Reach(State::kRun);
  Step(With(Cause::kSingular));
  Step(Asking(Request::kStart));
  EXPECT_EQ(supervisor_.state(), State::kHold);
  EXPECT_EQ(supervisor_.refusals(), Bit(Refusal::kCauseActive));
  StepFor(Quiet(), config_.hold_clear_s);
  EXPECT_EQ(Step(Asking(Request::kStart)), State::kRun);
}

TEST_F(Supervised, RefusesWithEveryReason) {
  Reach(State::kMonitor);
  SupervisorInput bad;
  bad.drives_ready = true;
  bad.speed_rad_s = 1.0;
  bad.request = Request::kArm;
  Step(bad);
  EXPECT_EQ(supervisor_.refusals(), Bit(Refusal::kSamples) | Bit(Refusal::kMoving));
  EXPECT_EQ(supervisor_.state(), State::kMonitor);
  Reach(State::kHold);
  SupervisorInput alone;
  alone.request = Request::kStart;
  Step(alone);
  EXPECT_EQ(supervisor_.refusals(),
            Bit(Refusal::kNeighbours) | Bit(Refusal::kNotSynced) | Bit(Refusal::kCauseActive));
  const auto refuses = [&](State state, Request request) {
    Reach(state);
    Step(Asking(request));
    return supervisor_.refusals() == Bit(Refusal::kState);
  };
  for (const Request request : {Request::kStart, Request::kHold})
    EXPECT_TRUE(refuses(State::kMonitor, request)) << NameOf(request);
  EXPECT_TRUE(refuses(State::kRun, Request::kReset));
  for (const Request request : {Request::kArm, Request::kStart, Request::kHold})
    EXPECT_TRUE(refuses(State::kFault, request)) << NameOf(request);
}

TEST_F(Supervised, WhatIsSoAlreadyIsNotRefusedAndChangesNothing) {
  const std::vector<std::pair<State, Request>> already = {
      {State::kArming, Request::kArm},    {State::kHold, Request::kArm},      {State::kRun, Request::kArm},
      {State::kRun, Request::kStart},     {State::kHold, Request::kHold},     {State::kInit, Request::kReset},
      {State::kMonitor, Request::kReset}, {State::kDegraded, Request::kStart}};
  for (const auto& [state, request] : already) {
    Reach(state);
    SupervisorInput in = Asking(request);
    in.drives_enabled = in.drives_ready && GivesTorque(state) && state != State::kArming;
    in.drives_ready = state != State::kInit;
    EXPECT_EQ(Step(in), state) << NameOf(state) << ", " << NameOf(request);
    EXPECT_EQ(supervisor_.refusals(), 0u) << NameOf(state) << ", " << NameOf(request);
  }
}

TEST_F(Supervised, ArmingThatTakesTooLongIsAFault) {
  Reach(State::kArming);
  SupervisorInput off = Quiet();
  off.drives_enabled = false;
  EXPECT_EQ(StepFor(off, config_.arming_max_s), State::kArming);
  EXPECT_EQ(StepFor(off, 2 * kPeriod_s), State::kFault);
  EXPECT_EQ(supervisor_.cause(), Cause::kArmingTimeout);
}

TEST_F(Supervised, TheLawTakesOverGraduallyAfterAStart) {
  Reach(State::kRun);
  double last = supervisor_.law_share();
  EXPECT_NEAR(last, kPeriod_s / config_.law_ramp_s, 1e-12);
  while (last < 1.0) {
    Step(Quiet());
    EXPECT_NEAR(supervisor_.law_share() - last, kPeriod_s / config_.law_ramp_s, 1e-9);
    last = supervisor_.law_share();
  }
  Step(With(Cause::kSampleLate));
  EXPECT_EQ(supervisor_.law_share(), 1.0);
}

TEST_F(Supervised, AnEmulatedArmMayStartRunningButOnlyOnce) {
  supervisor_ = Supervisor(config_, StartMode::kRunning);
  SupervisorInput unheard = Quiet();
  unheard.samples_valid = false;
  EXPECT_EQ(Step(unheard), State::kInit) << "no sample yet";
  EXPECT_EQ(Step(Quiet()), State::kRun);
  EXPECT_EQ(supervisor_.law_share(), 1.0);
  Step(With(Cause::kBusOff));
  Step(Asking(Request::kReset));
  EXPECT_EQ(StepFor(Quiet(), 1.0), State::kMonitor);
  supervisor_ = Supervisor(config_, StartMode::kRunning);
  SupervisorInput off = Quiet();
  off.drives_enabled = false;
  EXPECT_EQ(Step(off), State::kFault) << "drives that are not enabled";
}

TEST_F(Supervised, TellsNeighboursOfItsStopButPassesAnothersOnOnlyForAWhile) {
  Reach(State::kHold);
  EXPECT_FALSE(supervisor_.announces_stop()) << "armed, and never started";
  Reach(State::kRun);
  EXPECT_FALSE(supervisor_.announces_stop());
  Step(With(Cause::kSingular));
  EXPECT_TRUE(supervisor_.announces_stop());
  StepFor(Quiet(), config_.hold_clear_s);
  EXPECT_FALSE(supervisor_.announces_stop()) << "it could be started again";

  Reach(State::kRun);
  Step(With(Cause::kFleetStop));
  EXPECT_TRUE(supervisor_.announces_stop());
  StepFor(With(Cause::kFleetStop), config_.relay_s);
  EXPECT_FALSE(supervisor_.announces_stop()) << "or two arms would hold each other for ever";
  for (const State state : {State::kSafeStop, State::kFault}) {
    Reach(state);
    EXPECT_TRUE(supervisor_.announces_stop());
  }
}

// Over all states, causes and requests: what is taken is in the table, and all of the table is taken.
TEST_F(Supervised, EveryTransitionIsTaken) {
  uint32_t taken = 0;
  const auto note = [&] { taken |= supervisor_.transitions_taken(); };
  std::vector<SupervisorInput> inputs;
  for (const CauseRule& rule : kCauseRules) inputs.push_back(With(rule.cause));
  for (int i = 0; i < kRequests; ++i) inputs.push_back(Asking(static_cast<Request>(i)));
  SupervisorInput off = Quiet();
  off.drives_ready = off.drives_enabled = false;
  inputs.push_back(off);
  for (int i = 0; i < kControllerStates; ++i) {
    for (const SupervisorInput& in : inputs) {
      Reach(static_cast<State>(i));
      Step(in);
      StepFor(Quiet(), 2.0);
      note();
    }
  }
  for (const bool enabled : {true, false}) {
    supervisor_ = Supervisor(config_, StartMode::kRunning);
    SupervisorInput in = Quiet();
    in.drives_enabled = enabled;
    Step(in);
    note();
  }
  for (size_t i = 0; i < kTransitions.size(); ++i) {
    EXPECT_NE(taken & (uint32_t{1} << i), 0u)
        << NameOf(kTransitions[i].from) << " to " << NameOf(kTransitions[i].to) << " by "
        << TextOf(kTransitions[i].trigger);
  }
}

}  // namespace
}  // namespace armada
