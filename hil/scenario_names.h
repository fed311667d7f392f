#pragma once

#include "firmware/app/config/enum_names.h"
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

}  // namespace armada
