// What a tick of the supervisor costs: build/release/bin/core_test --gtest_filter='Cost.*'

#include <gtest/gtest.h>

#include "firmware/app/heap_counter.h"
#include "firmware/core/motion_watch.h"
#include "tests/core/paper_setting.h"
#include "tests/support/cost.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

TEST(Cost, OfTheSupervisorIsAtMostAMicrosecondATick) {
  if (!HeapCounter::available()) GTEST_SKIP() << "sanitizers cost more than they judge";
  RandomArms random(1);
  const ArmControllerConfig config = PaperController(random.Config(kMaxDof));
  MotionWatch watch(config.control.supervisor, config.arm);
  Supervisor supervisor(config.control.supervisor, StartMode::kRunning);
  const MotionSeen seen{.q_rad = random.Numbers(kMaxDof, 1.0),
                        .error_m = 0.001,
                        .sigma_min = 0.5,
                        .follows = true,
                        .synced = true};
  SupervisorInput in;
  in.drives_ready = in.drives_enabled = true;
  in.samples_valid = in.samples_good = in.neighbours_good = in.synced = true;
  EXPECT_LT(Cost_us("supervisor and motion watch, a tick",
                    [&] {
                      in.causes = watch.Update(seen, 0.01);
                      supervisor.Step(in, 0.01);
                    }),
            1.0);
  EXPECT_EQ(supervisor.state(), ControllerState::kRun);
}

}  // namespace
}  // namespace armada
