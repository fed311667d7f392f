#pragma once

#include <string>

#include "hil/fault.h"

namespace armada {

/// At whom a fault is aimed.
enum class FaultTarget {
  kArm,       ///< one arm
  kLeader,    ///< the leader
  kSender,    ///< one arm or the leader: who sends on a channel
  kComputer,  ///< the computer that the programs run on
};

/// Who makes a fault of a run in real time.
enum class FaultMaker {
  kNobody,     ///< it is of virtual time
  kEmulation,  ///< armada-hil, which has the drives and their buses in its hands
  kRun,        ///< `armada run`, which has the processes
  kRunOnly,    ///< the same, and in virtual time there is nothing that it could act on
};

/// When a fault is over.
enum class FaultEnd {
  kNever,  ///< it happens once: until_s is not given
  kMay,    ///< at until_s, or never
  kMust,   ///< at until_s
};

/// What the `value` of a fault may be. Without a unit of its own it has none to give.
struct FaultValue {
  const char* meaning = "";  ///< empty: the fault has no value
  const char* unit = "";
  double min = 0.0;
  double max = 0.0;
};

/// What a kind of fault wants and does: the rules of a scenario and its documentation.
struct FaultMeaning {
  FaultKind kind;
  FaultTarget target;
  FaultEnd end;
  FaultMaker maker;
  FaultValue value;  ///< of kDrive: see ValueOf
  const char* what;
};
const FaultMeaning& MeaningOf(FaultKind kind);

/// What the fault's `value` may be, its signal and its way considered.
FaultValue ValueOf(const FaultConfig& fault);

/// Every kind, and every way of kDrive, as the two tables of docs/faults.md.
std::string FaultTables();

}  // namespace armada
