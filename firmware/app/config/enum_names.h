#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/app/fleet.h"
#include "firmware/core/control_config.h"
#include "firmware/core/estimator.h"

namespace armada {

// Names of the kinds that a configuration chooses between. An overload of EnumNames, found by the kind's
// namespace, is all that a kind needs in order to be read, written and documented.

constexpr auto EnumNames(EstimatorKind) {
  using enum EstimatorKind;
  return std::to_array<std::pair<EstimatorKind, std::string_view>>(
      {{kPaper, "paper"}, {kImplicit, "implicit"}, {kPredictive, "predictive"}});
}

constexpr auto EnumNames(LawKind) {
  using enum LawKind;
  return std::to_array<std::pair<LawKind, std::string_view>>({{kPaper, "paper"}, {kRobust, "robust"}});
}

constexpr auto EnumNames(AdaptationKind) {
  using enum AdaptationKind;
  return std::to_array<std::pair<AdaptationKind, std::string_view>>(
      {{kNone, "none"}, {kKalman, "kalman"}, {kGradient, "gradient"}, {kBoth, "both"}});
}

constexpr auto EnumNames(SubtaskKind) {
  using enum SubtaskKind;
  return std::to_array<std::pair<SubtaskKind, std::string_view>>(
      {{kNone, "none"}, {kPosture, "posture"}, {kManipulability, "manipulability"}});
}

constexpr auto EnumNames(PostureForm) {
  using enum PostureForm;
  return std::to_array<std::pair<PostureForm, std::string_view>>({{kPrinted, "printed"}, {kExact, "exact"}});
}

constexpr auto EnumNames(ObstacleKind) {
  using enum ObstacleKind;
  return std::to_array<std::pair<ObstacleKind, std::string_view>>(
      {{kDisc, "disc"}, {kHalfPlane, "half_plane"}});
}

constexpr auto EnumNames(FleetStop) {
  using enum FleetStop;
  return std::to_array<std::pair<FleetStop, std::string_view>>({{kCarryOn, "carry_on"}, {kHold, "hold"}});
}

constexpr auto EnumNames(DriveProfile) {
  using enum DriveProfile;
  return std::to_array<std::pair<DriveProfile, std::string_view>>(
      {{kODriveCanSimple, "odrive_cansimple"},
       {kODriveCanSimpleV05, "odrive_cansimple_v05"},
       {kMiniCheetah, "mini_cheetah"},
       {kCubeMars, "cubemars"},
       {kDamiao, "damiao"},
       {kCia402, "cia402"},
       {kMoteus, "moteus"}});
}

template <class Enum>
concept NamedEnum = requires(Enum value) {
  EnumNames(value).front().second;
};

template <NamedEnum Enum>
std::string_view NameOf(Enum value) {
  for (const auto& [candidate, name] : EnumNames(value)) {
    if (candidate == value) return name;
  }
  return "?";
}

template <NamedEnum Enum>
std::optional<Enum> EnumNamed(std::string_view name) {
  for (const auto& [candidate, its_name] : EnumNames(Enum{})) {
    if (its_name == name) return candidate;
  }
  return std::nullopt;
}

/// "paper", "robust": all names, quoted.
template <NamedEnum Enum>
std::string AllNames(Enum kind) {
  std::string text;
  for (const auto& [candidate, name] : EnumNames(kind)) {
    if (!text.empty()) text += ", ";
    text.append("\"").append(name).append("\"");
  }
  return text;
}

}  // namespace armada
