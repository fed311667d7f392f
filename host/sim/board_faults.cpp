#include "host/sim/board_faults.h"

#include <iterator>

namespace armada {

BoardFaults::BoardFaults(const std::vector<FaultConfig>& faults, int arm_id) : arm_id_(arm_id) {
  std::copy_if(faults.begin(), faults.end(), std::back_inserter(faults_),
               [&](const FaultConfig& fault) { return fault.arm == arm_id; });
}

bool BoardFaults::Kills(double t_s) const {
  return Holds(FaultKind::kControllerDies, t_s) || Holds(FaultKind::kControllerRestarts, t_s);
}

BusStatus BoardFaults::BusAt(double t_s, double period_s) const {
  if (Holds(FaultKind::kBusDown, t_s)) return BusStatus::kDown;
  if (Holds(FaultKind::kBusOff, t_s)) return BusStatus::kBusOff;
  if (Holds(FaultKind::kBusOff, t_s - period_s)) return BusStatus::kRestarted;
  if (Holds(FaultKind::kErrorPassive, t_s)) return BusStatus::kErrorPassive;
  return Holds(FaultKind::kErrorPassive, t_s - period_s) ? BusStatus::kErrorActive : BusStatus::kOk;
}

double BoardFaults::ComputeTime_s(double t_s) const {
  const FaultConfig* const slow = FindActive(faults_, FaultKind::kSlowTick, arm_id_, t_s);
  return slow == nullptr ? 0.0 : slow->value;
}

}  // namespace armada
