#pragma once

#include <string>
#include <vector>

namespace armada {

/// What no fault may bring about. docs/safety.md has the list.
enum class Invariant {
  kTorqueInLimits,  ///< no torque command is beyond the joint's limit, or no number
  kDriveStops,      ///< without a command a drive stops driving in time
  kNothingRearms,   ///< no drive comes on, and no arm follows, unless an operator asked for it
  kOthersTrack,     ///< arms that are not hit and have a path to the leader track it
  kHoldsInTime,     ///< arms that nobody tells of the leader hold in time
  kNoWildMotion,    ///< no arm is driven about far from where it should be
  kNoHeap,          ///< the boards' own code allocates nothing
  kNoCrash,         ///< nothing crashes
};

constexpr const char* TextOf(Invariant invariant) {
  switch (invariant) {
    case Invariant::kTorqueInLimits:
      return "torque commands are finite and within limits";
    case Invariant::kDriveStops:
      return "drives stop in time";
    case Invariant::kNothingRearms:
      return "nothing re-arms";
    case Invariant::kOthersTrack:
      return "unaffected arms with a path to the leader track";
    case Invariant::kHoldsInTime:
      return "arms without a path to the leader hold in time";
    case Invariant::kNoWildMotion:
      return "no arm is driven about far from the leader";
    case Invariant::kNoHeap:
      return "no heap allocation in a board";
    case Invariant::kNoCrash:
      break;
  }
  return "no crash";
}

struct Violation {
  Invariant invariant;
  double t_s = 0.0;
  int arm = 0;  ///< id; 0: of none
  std::string what;
};

using Violations = std::vector<Violation>;

}  // namespace armada
