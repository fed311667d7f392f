#pragma once

#include <cstdint>

namespace armada {

/// The emulation's clock and its only wait: the machine's in the process, made up in tests.
class HilClock {
 public:
  virtual ~HilClock() = default;

  /// CLOCK_MONOTONIC, ns.
  virtual int64_t Now() = 0;

  /// Waits until `deadline_ns`, or until a bus has input; may return earlier. False once the run is asked to
  /// end.
  virtual bool WaitUntil(int64_t deadline_ns) = 0;
};

}  // namespace armada
