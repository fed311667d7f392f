#include "tests/fuzz/drive_world.h"

/// Fuzzer of one drive profile, ARMADA_FUZZ_PROFILE: master and emulated drive under the actions that the
/// input stands for (drive_actions.h).
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  ByteSource input({data, size});
  DriveWorld world(SetupOf(DriveProfile::ARMADA_FUZZ_PROFILE, input.Byte()));
  constexpr int64_t kLongestRun_ns = 10'000'000'000;  // an action may take a second, and many are no news
  while (!input.empty() && world.now_ns() < kLongestRun_ns) {
    world.Act(static_cast<DriveAction>(input.Byte() % kActions), &input);
  }
  return 0;
}
