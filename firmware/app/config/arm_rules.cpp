#include <algorithm>
#include <cmath>

#include "firmware/app/config/fleet_rules.h"
#include "firmware/app/config/value_text.h"
#include "firmware/can/bus_name.h"
#include "firmware/can/make_drive.h"
#include "firmware/can/value_format.h"

namespace armada {
namespace {

/// The rules of one arm. Each may assume that what it reads was read without an error.
class ArmRules {
 public:
  ArmRules(const FleetLayout& fleet, const ArmLayout& arm, const ConfigCursor& root, const ConfigCursor& at,
           std::vector<ConfigError>* errors)
      : fleet_(fleet), arm_(arm), root_(root), at_(at), errors_(errors) {}

  void CheckAll() {
    if (IsClean(at_.At("bus"), *errors_)) CheckBus();
    const bool links_good = CheckLinks();
    if (!links_good) return;  // everything below counts or measures links
    CheckJoints();
    if (!IsClean(at_.At("control"), *errors_) || !IsClean(root_.At("control"), *errors_)) return;
    CheckCounts();
    CheckLaw();
    CheckSubtask();
    CheckBarriers(arm_, fleet_.timing.period_s, root_, at_, errors_);
    const bool bounds_good = CheckProjectionBounds();
    if (!IsClean(at_, *errors_)) return;
    CheckReach();
    if (bounds_good && arm_.control.law == LawKind::kRobust) CheckNominalParameters();
  }

 private:
  int dof() const { return static_cast<int>(arm_.link.size()); }

  /// A value of the local law: this arm's own, else the fleet's, else where the arm's own would stand.
  ConfigCursor Control(const std::string& key) const {
    const ConfigCursor own = at_.At("control." + key);
    const ConfigCursor of_fleet = root_.At("control." + key);
    return own.found() || !of_fleet.found() ? own : of_fleet;
  }

  void CheckBus() {
    std::string error;
    if (!ParseBusName(arm_.bus, &error)) Report(at_.At("bus"), error, errors_);
  }

  bool CheckLinks() {
    const ConfigCursor links = at_.At("link");
    if (!IsClean(links, *errors_)) return false;
    if (arm_.link.empty() || arm_.link.size() > size_t{kMaxDof}) {
      Report(
          links,
          "given " + std::to_string(arm_.link.size()) + " links, allowed are 1 to " + std::to_string(kMaxDof),
          errors_);
      return false;
    }
    for (size_t i = 0; i < arm_.link.size(); ++i) {
      const LinkConfig& link = arm_.link[i];
      if (link.r_m <= link.l_m) continue;
      Report(links.Element(i).At("r_m"),
             "given " + ValueText(link.r_m) +
                 " m, allowed is above 0 up to the link's l_m = " + ValueText(link.l_m) + " m",
             errors_);
    }
    return true;
  }

  void CheckJoints() {
    const ConfigCursor joints = at_.At("joint");
    if (!IsClean(joints, *errors_) || !IsClean(at_.At("torque_limit_Nm"), *errors_)) return;
    const auto limits = arm_.torque_limit_Nm.size();
    if (limits > 1 && limits != dof()) {
      Report(at_.At("torque_limit_Nm"),
             "given " + std::to_string(limits) + " values, allowed are 1 or one a joint, " +
                 std::to_string(dof()),
             errors_);
      return;
    }
    if (arm_.joint.size() != arm_.link.size()) {
      Report(joints,
             "given " + std::to_string(arm_.joint.size()) + " joints, expected one a link, " +
                 std::to_string(dof()),
             errors_);
      return;
    }
    for (size_t i = 0; i < arm_.joint.size(); ++i) CheckJoint(i, joints.Element(i));
  }

  void CheckJoint(size_t i, const ConfigCursor& at) {
    const JointDriveConfig& joint = arm_.joint[i];
    const ConfigCursor limit = (at.found() ? at : at_).At("torque_limit_Nm");
    if (std::isnan(joint.torque_limit_Nm) && IsClean(limit, *errors_)) {
      Report(limit, "missing; it is the largest torque of the joint, here or for all joints of the arm",
             errors_);
    }
    if (std::abs(joint.direction) != 1.0) {
      Report(at.At("direction"), "given " + ValueText(joint.direction) + ", allowed are 1 and -1", errors_);
    }
    const NodeIdRange ids = NodeIdsOf(joint.profile);
    if (joint.node_id < ids.min || joint.node_id > ids.max) {
      Report(at.At("node_id"),
             "given " + std::to_string(joint.node_id) + ", allowed for a drive of " +
                 ValueText(joint.profile) + " is " + std::to_string(ids.min) + " to " +
                 std::to_string(ids.max),
             errors_);
      return;
    }
    for (size_t j = 0; j < i; ++j) {
      if (arm_.joint[j].node_id != joint.node_id) {
        if (CheckIdentifiers(i, j, at)) continue;
        break;
      }
      Report(at.At("node_id"),
             "given " + std::to_string(joint.node_id) + ", the node id of joint " + std::to_string(j + 1) +
                 " on the same bus, too",
             errors_);
      break;
    }
  }

  /// No frame of one joint's drive may be taken for one of another's. False, and reported, when it could be.
  bool CheckIdentifiers(size_t i, size_t j, const ConfigCursor& at) {
    for (const CanMessage& a : MessagesOf(arm_.joint[i])) {
      for (const CanMessage& b : MessagesOf(arm_.joint[j])) {
        if (a.id != b.id || a.extended != b.extended || a.fd != b.fd) continue;
        const bool broadcast = !a.from_drive && !b.from_drive && std::string_view(a.name) == b.name;
        const bool told_apart =
            a.multiplexor >= 0 && b.multiplexor >= 0 && a.multiplexor_raw != b.multiplexor_raw;
        if (broadcast || told_apart) continue;
        Report(at.At("node_id"),
               "with " + std::to_string(arm_.joint[i].node_id) + " the frame " + a.name +
                   " has the identifier " + Hexadecimal(a.id, 3) + " of joint " + std::to_string(j + 1) +
                   "'s frame " + b.name + "; allowed are addresses that keep them apart",
               errors_);
        return false;
      }
    }
    return true;
  }

  void CheckCount(const char* key, Eigen::Index count, int wanted, const char* of) {
    if (count == 1 || count == wanted) return;
    Report(Control(key),
           "given " + std::to_string(count) + " values, allowed for arm " + std::to_string(arm_.id) +
               " are 1 or one " + of + ", " + std::to_string(wanted),
           errors_);
  }

  void CheckCounts() {
    const GainsConfig& gains = arm_.control.gains;
    CheckCount("gains.K_s_Nms_rad", gains.K_s_Nms_rad.size(), dof(), "a joint");
    CheckCount("gains.K_r_Nm", gains.K_r_Nm.size(), dof(), "a joint");
    CheckCount("gains.K_x_Ns_m", gains.K_x_Ns_m.size(), PlanarArm::kTaskDim, "an axis");
    const SensorConfig& sensor = arm_.control.sensor;
    CheckCount("sensor.position_deviation_rad", sensor.position_deviation_rad.size(), dof(), "a joint");
    CheckCount("sensor.velocity_deviation_rad_s", sensor.velocity_deviation_rad_s.size(), dof(), "a joint");
  }

  void CheckLaw() {
    if (arm_.control.law == LawKind::kPaper && dof() < PlanarArm::kTaskDim) {
      Report(Control("law"),
             "given \"paper\", which needs at least 2 joints; arm " + std::to_string(arm_.id) +
                 " has 1: allowed is \"robust\"",
             errors_);
    }
  }

  void CheckSubtask() {
    const SubtaskConfig& subtask = arm_.control.subtask;
    if (subtask.kind == SubtaskKind::kNone) return;
    if (dof() <= PlanarArm::kTaskDim) {
      Report(Control("subtask.kind"),
             "given " + ValueText(subtask.kind) + ", which needs more than 2 joints; arm " +
                 std::to_string(arm_.id) + " has " + std::to_string(dof()) + ": allowed is \"none\"",
             errors_);
    } else if (subtask.joint > dof()) {
      Report(Control("subtask.joint"),
             "given " + std::to_string(subtask.joint) + ", allowed for arm " + std::to_string(arm_.id) +
                 " is 1 to " + std::to_string(dof()),
             errors_);
    }
  }

  bool CheckProjectionBounds() {
    const ProjectionConfig& set = arm_.control.projection;
    const auto check = [&](const std::string& quantity, const char* unit, double min, double max) {
      if (min < max) return true;
      Report(Control("projection." + quantity + "_min_" + unit),
             "given " + ValueText(min) + ", allowed is below projection." + quantity + "_max_" + unit +
                 " = " + ValueText(max),
             errors_);
      return false;
    };
    const bool inertia_good = check("inertia", "kgm2", set.inertia_min_kgm2, set.inertia_max_kgm2);
    const bool gravity_good = check("gravity", "kgm", set.gravity_min_kgm, set.gravity_max_kgm);
    return inertia_good && gravity_good;
  }

  void CheckReach() {
    if (dof() < PlanarArm::kTaskDim) return;  // its reach is a circle
    const PlanarArm arm(PlanarArmOf(arm_));
    const ReferenceConfig& reference = arm_.control.reference;
    const double inner = arm.reach_min_m() + reference.reach_inner_margin_m;
    const double outer = arm.reach_max_m() - reference.reach_outer_margin_m;
    if (inner < outer) return;
    Report(Control("reference.reach_inner_margin_m"),
           "with both margins arm " + std::to_string(arm_.id) + " has no reach left: " + RoundedText(inner) +
               " to " + RoundedText(outer) + " m; allowed is less together than " +
               RoundedText(arm.reach_max_m() - arm.reach_min_m()) + " m",
           errors_);
  }

  /// theta_hat could never become true if the true parameters were outside the set that it is kept in.
  void CheckNominalParameters() {
    const PlanarArm arm(PlanarArmOf(arm_));
    const ParameterVector theta = arm.Theta();
    const ProjectionConfig& set = arm_.control.projection;
    if (InProjectionSet(set, arm, theta)) return;
    const int n = arm.dof();
    double coupling = 0.0;
    for (int a = 0; a < n; ++a) {
      const double D_aa = theta[arm.InertiaIndex(a, a)];
      const std::string name = "D_" + std::to_string(a + 1) + std::to_string(a + 1);
      if (D_aa < set.inertia_min_kgm2) ReportTooHigh("inertia_min_kgm2", set.inertia_min_kgm2, name, D_aa);
      if (D_aa > set.inertia_max_kgm2) ReportTooLow("inertia_max_kgm2", set.inertia_max_kgm2, name, D_aa);
      for (int b = a + 1; b < n; ++b) {
        const double correlation =
            std::abs(theta[arm.InertiaIndex(a, b)]) / std::sqrt(D_aa * theta[arm.InertiaIndex(b, b)]);
        coupling = std::max(coupling, (n - 1) * correlation);
      }
    }
    if (coupling > set.correlation_max) {
      ReportTooLow("correlation_max", set.correlation_max, "(n - 1) |D_ab| / sqrt(D_aa D_bb)", coupling);
    }
    for (int p = arm.InertiaParameterCount(); p < arm.parameter_count(); ++p) {
      const std::string name = "G_" + std::to_string(p - arm.InertiaParameterCount() + 1);
      if (theta[p] > set.gravity_max_kgm)
        ReportTooLow("gravity_max_kgm", set.gravity_max_kgm, name, theta[p]);
    }
  }

  // Rounded so that what is said to be allowed is.
  void ReportTooHigh(const std::string& bound, double given, const std::string& parameter, double actual) {
    ReportBound(bound, given, parameter, actual, "at most " + ValueText(std::floor(actual * 1e3) / 1e3));
  }
  void ReportTooLow(const std::string& bound, double given, const std::string& parameter, double actual) {
    ReportBound(bound, given, parameter, actual, "at least " + ValueText(std::ceil(actual * 1e3) / 1e3));
  }
  void ReportBound(const std::string& bound, double given, const std::string& parameter, double actual,
                   const std::string& allowed) {
    Report(Control("projection." + bound),
           "given " + ValueText(given) + ", but the links of arm " + std::to_string(arm_.id) + " have " +
               parameter + " = " + RoundedText(actual) + ": allowed is " + allowed,
           errors_);
  }

  const FleetLayout& fleet_;
  const ArmLayout& arm_;
  const ConfigCursor root_;
  const ConfigCursor at_;
  std::vector<ConfigError>* errors_;
};

}  // namespace

void CheckArm(const FleetLayout& fleet, size_t index, const ConfigCursor& root,
              std::vector<ConfigError>* errors) {
  ArmRules(fleet, fleet.arm[index], root, root.At("arm").Element(index), errors).CheckAll();
}

}  // namespace armada
