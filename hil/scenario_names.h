#pragma once

#include "firmware/app/config/enum_names.h"
#include "firmware/core/parameter.h"
#include "hil/scenario.h"

namespace armada {

// Names of the kinds in a scenario file; see firmware/app/config/enum_names.h.

constexpr auto EnumNames(LeaderKind) {
  using enum LeaderKind;
  return std::to_array<std::pair<LeaderKind, std::string_view>>(
      {{kNone, "none"}, {kSine, "sine"}, {kWaypoints, "waypoints"}});
}

constexpr auto EnumNames(StartKind) {
  using enum StartKind;
  return std::to_array<std::pair<StartKind, std::string_view>>({{kBox, "box"}, {kNearLeader, "near_leader"}});
}

constexpr auto EnumNames(StartMode) {
  using enum StartMode;
  return std::to_array<std::pair<StartMode, std::string_view>>(
      {{kRunning, "running"}, {kMonitor, "monitor"}});
}

constexpr auto EnumNames(DisturbanceKind) {
  using enum DisturbanceKind;
  return std::to_array<std::pair<DisturbanceKind, std::string_view>>({{kNone, "none"},
                                                                      {kUniform, "uniform"},
                                                                      {kConstant, "constant"},
                                                                      {kSine, "sine"},
                                                                      {kAdversarial, "adversarial"}});
}

constexpr auto EnumNames(CriterionKind) {
  using enum CriterionKind;
  return std::to_array<std::pair<CriterionKind, std::string_view>>(
      {{kTracking, "tracking"}, {kAgreement, "agreement"}});
}

constexpr auto EnumNames(Request) {
  using enum Request;
  return std::to_array<std::pair<Request, std::string_view>>(
      {{kArm, "arm"}, {kStart, "start"}, {kHold, "hold"}, {kReset, "reset"}, {kEstop, "estop"}});
}

/// An operator who asks for nothing means nothing.
inline bool IsRequired(const ParameterInfo&, Request request) {
  return request == Request::kNone;
}

constexpr auto EnumNames(FaultKind) {
  using enum FaultKind;
  return std::to_array<std::pair<FaultKind, std::string_view>>({{kDrive, "drive"},
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

/// A fault without a kind means nothing.
inline bool IsRequired(const ParameterInfo&, FaultKind kind) {
  return kind == FaultKind::kNone;
}

constexpr auto EnumNames(FaultSignal) {
  using enum FaultSignal;
  return std::to_array<std::pair<FaultSignal, std::string_view>>({{kNone, "none"},
                                                                  {kPosition, "position"},
                                                                  {kVelocity, "velocity"},
                                                                  {kStatus, "status"},
                                                                  {kCurrent, "current"}});
}

constexpr auto EnumNames(FaultWay) {
  using enum FaultWay;
  return std::to_array<std::pair<FaultWay, std::string_view>>({{kNone, "none"},
                                                               {kOff, "off"},
                                                               {kStuck, "stuck"},
                                                               {kGarbage, "garbage"},
                                                               {kWrong, "wrong"},
                                                               {kSlow, "slow"},
                                                               {kDelayed, "delayed"},
                                                               {kIntermittent, "intermittent"}});
}

}  // namespace armada
