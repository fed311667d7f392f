#include "firmware/app/config/fleet_rules.h"

#include "firmware/app/config/value_text.h"
#include "firmware/can/bus_name.h"
#include "firmware/link/lcm_url.h"

namespace armada {
namespace {

using Errors = std::vector<ConfigError>;

void CheckTiming(const TimingConfig& timing, const ConfigCursor& at, Errors* errors) {
  if (!IsClean(at, *errors)) return;
  const auto check = [&](const char* key, double given_s, bool good, const char* side) {
    if (good) return;
    Report(at.At(key),
           "given " + ValueText(given_s) + " s, allowed is " + side +
               " timing.period_s = " + ValueText(timing.period_s) + " s",
           errors);
  };
  const double h = timing.period_s;
  check("sample_to_torque_s", timing.sample_to_torque_s, timing.sample_to_torque_s < h, "below");
  check("feedback_timeout_s", timing.feedback_timeout_s, timing.feedback_timeout_s < h, "below");
  check("feedback_stale_s", timing.feedback_stale_s, timing.feedback_stale_s > h, "above");
}

void CheckLcmUrl(const LcmLinkConfig& link, const ConfigCursor& at, Errors* errors) {
  if (!IsClean(at, *errors)) return;
  std::string error;
  const auto url = ParseLcmUrl(link.lcm_url, &error);
  if (!url) {
    Report(at, error, errors);
  } else if (url->ttl > 0 && !link.has_key()) {
    Report(at,
           "given ttl=" + std::to_string(url->ttl) +
               " without link.key_file: anyone on the network could move the arms. `armada key new FILE` "
               "makes a key",
           errors);
  }
}

// 0 where no earlier arm is equal in the sense given; else the earlier one's number from 1.
template <class Same>
size_t EarlierArm(const FleetLayout& fleet, size_t index, Same same) {
  for (size_t i = 0; i < index; ++i) {
    if (same(fleet.arm[i], fleet.arm[index])) return i + 1;
  }
  return 0;
}

bool SameId(const ArmLayout& a, const ArmLayout& b) {
  return a.id == b.id;
}

bool SameBus(const ArmLayout& a, const ArmLayout& b) {
  std::string ignored;
  const auto bus_a = ParseBusName(a.bus, &ignored);
  const auto bus_b = ParseBusName(b.bus, &ignored);
  return bus_a && bus_b && bus_a->kind == bus_b->kind && bus_a->group == bus_b->group &&
         bus_a->port == bus_b->port && bus_a->interface_name == bus_b->interface_name;
}

void CheckUnique(const FleetLayout& fleet, const ConfigCursor& arms, Errors* errors) {
  for (size_t i = 0; i < fleet.arm.size(); ++i) {
    const ArmLayout& arm = fleet.arm[i];
    const ConfigCursor at = arms.Element(i);
    const auto line_of = [&](size_t number) { return std::to_string(arms.Element(number - 1).node().line); };
    if (const size_t earlier = EarlierArm(fleet, i, SameId); earlier > 0 && arm.id != 0) {
      Report(at.At("id"),
             "given " + std::to_string(arm.id) + ", the id of the arm in line " + line_of(earlier) + ", too",
             errors);
    }
    if (const size_t earlier = EarlierArm(fleet, i, SameBus); earlier > 0) {
      Report(at.At("bus"),
             "given " + ValueText(arm.bus) + ", the bus of the arm in line " + line_of(earlier) +
                 ", too; each arm has a bus of its own",
             errors);
    }
  }
}

}  // namespace

void CheckFleet(const FleetLayout& fleet, const ConfigCursor& root, Errors* errors) {
  CheckTiming(fleet.timing, root.At("timing"), errors);
  CheckLcmUrl(fleet.link, root.At("link.lcm_url"), errors);

  const ConfigCursor arms = root.At("arm");
  if (fleet.arm.empty() && IsClean(arms, *errors))
    Report(arms, "no arm is given, allowed are 1 to 64 [[arm]]", errors);
  if (fleet.arm.size() > size_t{kMaxArms}) {
    Report(
        arms,
        "given " + std::to_string(fleet.arm.size()) + " arms, allowed are 1 to " + std::to_string(kMaxArms),
        errors);
    return;
  }
  CheckUnique(fleet, arms, errors);
  bool ids_clean = true;
  for (size_t i = 0; i < fleet.arm.size(); ++i) {
    ids_clean = ids_clean && IsClean(arms.Element(i).At("id"), *errors);
    CheckArm(fleet, i, root, errors);
  }
  if (ids_clean && !fleet.arm.empty()) CheckGraphs(fleet, root, errors);
}

}  // namespace armada
