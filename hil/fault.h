#pragma once

#include <algorithm>
#include <vector>

#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

/// What a fault does. What each kind wants besides, and what `value` means: hil/fault_meaning.h.
enum class FaultKind {
  kNone,  ///< not said

  // A joint's drive.
  kDrive,
  kDriveError,

  // An arm's CAN bus.
  kBusLoss,
  kBusDelay,
  kBusOff,
  kErrorPassive,
  kBusDown,
  kQueueFull,

  // An arm's board.
  kControllerDies,
  kControllerStops,
  kControllerRestarts,
  kSlowTick,

  // The computer that the programs run on.
  kCpuHog,

  // The leader.
  kLeaderDies,
  kLeaderStops,
  kLeaderJumps,
  kLeaderNonfinite,

  // The link between the boards.
  kLinkLoss,
  kPartition,
  kReplay,
  kReorder,
  kForge,
  kJunk,
};

constexpr auto EnumNames(FaultKind) {
  using enum FaultKind;
  return std::to_array<EnumName<FaultKind>>({{kDrive, "drive"},
                                             {kDriveError, "drive_error"},
                                             {kBusLoss, "bus_loss"},
                                             {kBusDelay, "bus_delay"},
                                             {kBusOff, "bus_off"},
                                             {kErrorPassive, "error_passive"},
                                             {kBusDown, "bus_down"},
                                             {kQueueFull, "queue_full"},
                                             {kControllerDies, "controller_dies"},
                                             {kControllerStops, "controller_stops"},
                                             {kControllerRestarts, "controller_restarts"},
                                             {kSlowTick, "slow_tick"},
                                             {kCpuHog, "cpu_hog"},
                                             {kLeaderDies, "leader_dies"},
                                             {kLeaderStops, "leader_stops"},
                                             {kLeaderJumps, "leader_jumps"},
                                             {kLeaderNonfinite, "leader_nonfinite"},
                                             {kLinkLoss, "link_loss"},
                                             {kPartition, "partition"},
                                             {kReplay, "replay"},
                                             {kReorder, "reorder"},
                                             {kForge, "forge"},
                                             {kJunk, "junk"}});
}

/// What of a drive is wrong.
enum class FaultSignal {
  kNone,
  kPosition,  ///< as the drive senses it
  kVelocity,  ///< as the drive senses it
  kStatus,    ///< as the drive tells it
  kCurrent,   ///< the torque that the drive produces
};

constexpr auto EnumNames(FaultSignal) {
  using enum FaultSignal;
  return std::to_array<EnumName<FaultSignal>>({{kNone, "none"},
                                               {kPosition, "position"},
                                               {kVelocity, "velocity"},
                                               {kStatus, "status"},
                                               {kCurrent, "current"}});
}

/// In which way.
enum class FaultWay { kNone, kOff, kStuck, kGarbage, kWrong, kSlow, kDelayed, kIntermittent };

constexpr auto EnumNames(FaultWay) {
  using enum FaultWay;
  return std::to_array<EnumName<FaultWay>>({{kNone, "none"},
                                            {kOff, "off"},
                                            {kStuck, "stuck"},
                                            {kGarbage, "garbage"},
                                            {kWrong, "wrong"},
                                            {kSlow, "slow"},
                                            {kDelayed, "delayed"},
                                            {kIntermittent, "intermittent"}});
}

/// Something that goes wrong at a time of the run.
struct FaultConfig {
  static constexpr double kForGood_s = 1e6;

  FaultKind kind = FaultKind::kNone;
  double at_s = -1.0;
  double until_s = kForGood_s;
  int arm = 0;
  int joint = 0;
  FaultSignal signal = FaultSignal::kNone;
  FaultWay way = FaultWay::kNone;
  double value = 0.0;

  bool IsActive(double t_s) const { return t_s >= at_s - 1e-9 && t_s < until_s - 1e-9; }

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "kind of the fault; docs/faults.md says what each wants"}, kind);
    parameter({"at_s", "s", 0, kForGood_s, "time at which it begins"}, at_s);
    parameter({"until_s", "s", 0, kForGood_s, "time at which it is over"}, until_s);
    parameter({"arm", "", 0, kMaxArms, "id of the arm; 0: the leader, or the computer"}, arm);
    parameter({"joint", "", 0, kMaxDof, "drive, drive_error: the joint, from 1; 0: every joint of the arm"},
              joint);
    parameter({"signal", "", 0, 0, "drive: what of it is wrong"}, signal);
    parameter({"way", "", 0, 0, "drive: in which way"}, way);
    parameter({"value", "", -1e6, 1e6, "how much; docs/faults.md says of what, and in which unit"}, value);
  }
};

/// The first fault of the kind that holds at `t_s`; null when there is none. `arm` 0: the leader.
inline const FaultConfig* FindActive(const std::vector<FaultConfig>& faults, FaultKind kind, int arm,
                                     double t_s) {
  const auto found = std::find_if(faults.begin(), faults.end(), [&](const FaultConfig& fault) {
    return fault.kind == kind && fault.arm == arm && fault.IsActive(t_s);
  });
  return found == faults.end() ? nullptr : &*found;
}

}  // namespace armada
