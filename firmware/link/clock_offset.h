#pragma once

#include <cstdint>

#include "firmware/core/parameter.h"

namespace armada {

/// When a message was sent, on the sender's clock, and when it came, on ours. Both clocks are monotonic; no
/// time is negative or above kMaxStampNs (messages.h refuses others), so that no difference overflows.
struct MessageTime {
  int64_t sequence = 0;
  int64_t stamp_ns = 0;
  int64_t arrival_ns = 0;
};

enum class Freshness {
  kNew,        ///< newer than every message before: use it
  kRestarted,  ///< the first of a sender, or of one that was started again or whose clock was set back: use
               ///< it
  kStale,      ///< late, repeated or replayed: drop it
};

/// A receiver's estimate of one sender's clock (boards have different ones). The smallest (arrival - stamp)
/// of late is the offset of the clocks plus the wire time:
///   age = (now - stamp) - min(arrival - stamp) + wire_time.
/// The minimum is taken over the present window and the one before, so that it can rise again as the clocks
/// drift apart: a drift of d makes an age too large by at most 2 d window_s.
///
/// A sender counts and its clock runs forward; a message that is not newer in both is stale, unless the
/// sender has been silent for `silence_s`: then it has been restarted, and what was known of its clock is
/// forgotten.
class ClockOffset {
 public:
  struct Config {
    double window_s = 2.0;
    double wire_time_s = 50e-6;
    double silence_s = 0.05;

    void Visit(ParameterVisitor& parameter) {
      parameter({"window_s", "s", 0.1, 100, "time over which the earliest arrival of a sender is kept"},
                window_s);
      parameter(
          {"wire_time_s", "s", -0.1, 0.1,
           "smallest true time from a message's stamp to its arrival; negative when it is stamped ahead"},
          wire_time_s);
      parameter({"silence_s", "s", 1e-3, 10,
                 "silence after which a sender that counts anew is taken for restarted"},
                silence_s);
    }
  };

  explicit ClockOffset(const Config& config);

  /// Judges a message and, unless it is stale, learns from it. Arrivals are in order.
  Freshness Update(const MessageTime& message);

  /// How long ago a stamp of the sender was. Infinite before the first message.
  double AgeS(int64_t stamp_ns, int64_t now_ns) const;

 private:
  struct State {
    bool heard = false;
    MessageTime newest;
    int64_t window_start_ns = 0;
    int64_t window_min_ns = 0;    ///< smallest (arrival - stamp) of the present window
    int64_t previous_min_ns = 0;  ///< and of the one before
  };

  void Forget(const MessageTime& message);

  Config config_;
  State state_;
};

}  // namespace armada
