#include "host/can/can_check.h"

#include <algorithm>
#include <iomanip>
#include <ostream>

#include "firmware/can/bus_name.h"
#include "firmware/can/can_link.h"
#include "firmware/core/named_enum.h"
#include "host/check/bus_load.h"
#include "host/check/findings.h"
#include "host/json.h"

namespace armada {
namespace {

/// Above this, frames of the worst length do not leave room for a repetition or a tool.
constexpr double kHighLoad = 0.8;

std::string Percent(double share) {
  return Fixed(1e2 * share, 1) + " %";
}

std::string TextOf(const CanLink& link) {
  std::string text = link.kind + (link.up ? ", up" : ", down");
  if (link.bitrate_bit_s) text += ", " + std::to_string(*link.bitrate_bit_s) + " bit/s";
  if (link.data_bitrate_bit_s) text += ", data " + std::to_string(*link.data_bitrate_bit_s) + " bit/s";
  return text;
}

class Checker {
 public:
  CanCheckResult Check(const FleetConfig& fleet) {
    result_.fleet = fleet.file;
    for (const ArmEntry& entry : fleet.arms) CheckArm(entry, fleet.timing);
    std::stable_partition(result_.findings.begin(), result_.findings.end(),
                          [](const Finding& finding) { return finding.severity == Severity::kError; });
    return std::move(result_);
  }

 private:
  void Find(Severity severity, int arm_id, const std::string& text) {
    result_.findings.push_back({severity, "arm " + std::to_string(arm_id) + ": " + text});
  }

  void CheckArm(const ArmEntry& entry, const TimingConfig& timing) {
    BusCheck check;
    check.arm_id = entry.id;
    check.bus = entry.bus;
    check.joints = entry.joints;
    check.load = ArmBusLoad(entry, timing, EmulatedDriveConfig{});
    if (const std::string error = BusLoadError(check.load); !error.empty()) {
      Find(Severity::kError, entry.id, error);
    } else if (check.load > kHighLoad) {
      Find(Severity::kWarning, entry.id, "its bus is loaded to " + Percent(check.load));
    }
    CheckWatchdogs(entry);
    check.interface = CheckInterface(entry);
    result_.buses.push_back(std::move(check));
  }

  void CheckWatchdogs(const ArmEntry& entry) {
    std::string joints;
    for (size_t i = 0; i < entry.joints.size(); ++i) {
      const DriveProfile profile = entry.joints[i].profile;
      if (profile != DriveProfile::kMiniCheetah && profile != DriveProfile::kCubeMars) continue;
      joints += (joints.empty() ? "" : ", ") + std::to_string(i + 1);
    }
    if (joints.empty()) return;
    Find(Severity::kWarning, entry.id,
         "nothing proves the watchdogs of joints " + joints + ": test them on the bench (docs/can/mit.md)");
  }

  std::string CheckInterface(const ArmEntry& entry) {
    std::string error;
    const auto name = ParseBusName(entry.bus, &error);
    if (!name || name->kind == BusKind::kUdp) return "user-space bus";
    const auto link = ReadCanLink(name->interface_name, &error);
    if (!link) {
      Find(Severity::kWarning, entry.id, "interface " + name->interface_name + " is not on this machine");
      return "not here";
    }
    const std::string complaint = CheckCanLink(*link, BusOptionsOf(entry));
    if (!complaint.empty()) Find(Severity::kError, entry.id, complaint);
    return TextOf(*link);
  }

  CanCheckResult result_;
};

}  // namespace

bool CanCheckResult::ok() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity == Severity::kError; });
}

const char* WatchdogText(DriveProfile profile) {
  switch (profile) {
    case DriveProfile::kODriveCanSimple:
    case DriveProfile::kODriveCanSimpleV05:
      return "set in the drive; proved at bring-up: it must trip";
    case DriveProfile::kMiniCheetah:
    case DriveProfile::kCubeMars:
      return "set in the drive; cannot be proved";
    case DriveProfile::kDamiao:
      return "written to register 9 and read back: proved";
    case DriveProfile::kCia402:
      return "written to 1400h:05 and read back: proved";
    case DriveProfile::kMoteus:
      return "sent with every torque and read back: proved";
  }
  return "";
}

CanCheckResult CheckCan(const FleetConfig& fleet) {
  return Checker().Check(fleet);
}

void PrintText(const CanCheckResult& result, std::ostream& out) {
  for (const BusCheck& bus : result.buses) {
    out << "arm " << bus.arm_id << "  " << bus.bus << "  (" << bus.interface << ")  load "
        << Percent(bus.load) << '\n';
    for (size_t i = 0; i < bus.joints.size(); ++i) {
      const JointDriveConfig& joint = bus.joints[i];
      out << "    joint " << i + 1 << "  node " << std::left << std::setw(4) << joint.node_id << std::setw(21)
          << NameOf(joint.profile) << "watchdog " << Fixed(1e3 * joint.watchdog_s, 0) << " ms, "
          << WatchdogText(joint.profile) << '\n';
    }
  }
  out << "Load: every frame as long as stuff bits can make it.\n";
  for (const Finding& finding : result.findings) {
    out << (finding.severity == Severity::kError ? "error: " : "warning: ") << finding.text << '\n';
  }
  out << (result.ok() ? "ok" : "not ok") << '\n';
}

void PrintJson(const CanCheckResult& result, std::ostream& out) {
  Json json = {{"schema", 1}, {"file", result.fleet}, {"ok", result.ok()}};
  json["buses"] = Json::array();
  for (const BusCheck& bus : result.buses) {
    Json joints = Json::array();
    for (const JointDriveConfig& joint : bus.joints) {
      joints.push_back({{"profile", NameOf(joint.profile)},
                        {"node_id", joint.node_id},
                        {"watchdog_s", joint.watchdog_s},
                        {"watchdog", WatchdogText(joint.profile)}});
    }
    json["buses"].push_back({{"arm", bus.arm_id},
                             {"bus", bus.bus},
                             {"interface", bus.interface},
                             {"load", bus.load},
                             {"joints", std::move(joints)}});
  }
  json["findings"] = Json::array();
  for (const Finding& finding : result.findings) {
    const char* const severity = finding.severity == Severity::kError ? "error" : "warning";
    json["findings"].push_back({{"severity", severity}, {"text", finding.text}});
  }
  out << json.dump(2) << '\n';
}

}  // namespace armada
