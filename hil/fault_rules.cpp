#include "hil/fault_rules.h"

#include "firmware/app/config/value_text.h"
#include "hil/fault_meaning.h"
#include "hil/faulty_status.h"

namespace armada {
namespace {

/// The rules of one fault.
class FaultRules {
 public:
  FaultRules(const ScenarioConfig& scenario, const FaultConfig& fault, const ConfigCursor& at,
             std::vector<ConfigError>* errors)
      : scenario_(scenario), fault_(fault), meaning_(MeaningOf(fault.kind)), at_(at), errors_(errors) {}

  void CheckAll() {
    CheckArm();
    CheckJoint();
    CheckEnd();
    CheckSignal("signal", ValueText(fault_.signal), fault_.signal != FaultSignal::kNone);
    CheckSignal("way", ValueText(fault_.way), fault_.way != FaultWay::kNone);
    CheckStatus();
    CheckValue();
  }

 private:
  std::string OfKind() const { return "with kind = " + ValueText(fault_.kind); }

  void Refuse(const char* key, const std::string& given, const std::string& allowed) {
    Report(at_.At(key), "given " + given + ", allowed " + OfKind() + " " + allowed, errors_);
  }

  const ArmEntry* Arm() const {
    const int index = scenario_.fleet.IndexOf(fault_.arm);
    return index < 0 ? nullptr : &scenario_.fleet.arms[static_cast<size_t>(index)];
  }

  void CheckArm() {
    const bool has_leader = scenario_.leader.kind != LeaderKind::kNone;
    if (meaning_.target == FaultTarget::kComputer) {
      if (fault_.arm != 0) Refuse("arm", ValueText(fault_.arm), "is none");
      return;
    }
    const bool leader = meaning_.target != FaultTarget::kArm;
    if (leader && fault_.arm == 0) {
      if (!has_leader) Report(at_.At("arm"), "meant for the leader, but there is none", errors_);
      return;
    }
    if (meaning_.target == FaultTarget::kLeader) {
      Refuse("arm", ValueText(fault_.arm), "is 0, the leader");
    } else if (Arm() == nullptr) {
      std::string ids;
      for (const ArmEntry& arm : scenario_.fleet.arms) ids += (ids.empty() ? "" : ", ") + ValueText(arm.id);
      Refuse("arm", ValueText(fault_.arm), "are the arms " + ids + (leader ? ", and 0, the leader" : ""));
    }
  }

  void CheckJoint() {
    if (fault_.joint == 0) return;
    if (fault_.kind != FaultKind::kDrive && fault_.kind != FaultKind::kDriveError) {
      return Refuse("joint", ValueText(fault_.joint), "is none");
    }
    const ArmEntry* const arm = Arm();
    if (arm == nullptr || static_cast<size_t>(fault_.joint) <= arm->joints.size()) return;
    Report(at_.At("joint"),
           "given " + ValueText(fault_.joint) + ", allowed are 1 to " + std::to_string(arm->joints.size()) +
               " of arm " + ValueText(fault_.arm) + ", and 0, all of them",
           errors_);
  }

  void CheckEnd() {
    const bool ends = fault_.until_s != FaultConfig::kForGood_s;
    const std::string given = ValueText(fault_.until_s) + " s";
    if (ends && meaning_.end == FaultEnd::kNever) return Refuse("until_s", given, "is none");
    if (!ends && meaning_.end == FaultEnd::kMust) {
      Report(at_.At("until_s"), "missing; " + OfKind() + " it is the time at which it goes on", errors_);
    } else if (fault_.until_s <= fault_.at_s) {
      Report(at_.At("until_s"),
             "given " + given + ", allowed is above at_s = " + ValueText(fault_.at_s) + " s", errors_);
    }
  }

  void CheckSignal(const char* key, const std::string& given, bool is_given) {
    const bool wanted = fault_.kind == FaultKind::kDrive;
    if (wanted && !is_given) {
      Report(at_.At(key), "missing; " + OfKind() + " it must be given", errors_);
    } else if (!wanted && is_given) {
      Refuse(key, given, "is none");
    }
  }

  // Some drives tell nothing of their state.
  void CheckStatus() {
    const ArmEntry* const arm = Arm();
    if (fault_.kind != FaultKind::kDrive || fault_.signal != FaultSignal::kStatus || arm == nullptr) return;
    for (size_t i = 0; i < arm->joints.size(); ++i) {
      if (fault_.joint != 0 && static_cast<size_t>(fault_.joint) != i + 1) continue;
      if (TellsStatus(arm->joints[i])) continue;
      return Report(at_.At("signal"),
                    "given \"status\", but a drive with profile " + ValueText(arm->joints[i].profile) +
                        " tells nothing of its own",
                    errors_);
    }
  }

  void CheckValue() {
    const bool drive = fault_.kind == FaultKind::kDrive;
    if (drive && (fault_.signal == FaultSignal::kNone || fault_.way == FaultWay::kNone)) return;  // said
    const FaultValue value = ValueOf(fault_);
    const std::string whose =
        drive ? "with signal = " + ValueText(fault_.signal) + ", way = " + ValueText(fault_.way) : OfKind();
    const ConfigCursor at = at_.At("value");
    if (*value.meaning == '\0') {
      if (fault_.value != 0.0)
        Report(at, "given " + Number(fault_.value) + ", allowed " + whose + " is none", errors_);
      return;
    }
    if (!at.found()) return Report(at, "missing; " + whose + " it is the " + Text(value), errors_);
    if (fault_.value >= value.min && fault_.value <= value.max) return;
    Report(at,
           "given " + Number(fault_.value) + ", allowed " + whose + " is " + Number(value.min) + " to " +
               Number(value.max) + ", the " + Text(value),
           errors_);
  }

  static std::string Number(double value) { return ValueText(value); }
  static std::string Text(const FaultValue& value) {
    return std::string(value.meaning) + (*value.unit == '\0' ? "" : std::string(", ") + value.unit);
  }

  const ScenarioConfig& scenario_;
  const FaultConfig& fault_;
  const FaultMeaning& meaning_;
  ConfigCursor at_;
  std::vector<ConfigError>* errors_;
};

}  // namespace

void CheckFaults(const ScenarioConfig& scenario, const ConfigCursor& at, std::vector<ConfigError>* errors) {
  for (size_t i = 0; i < scenario.faults.size(); ++i) {
    FaultRules(scenario, scenario.faults[i], at.Element(i), errors).CheckAll();
  }
}

}  // namespace armada
