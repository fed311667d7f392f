#pragma once

#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/core/parameter.h"

namespace armada {

// The fleet file as it is written, table by table. FleetConfig is what it means: see FleetOf and LayoutOf.

struct EdgeLayout : Edge {
  void Visit(ParameterVisitor& parameter) {
    parameter({"from", "", 1, kMaxArms, "id of the arm that is listened to"}, from);
    parameter({"to", "", 1, kMaxArms, "id of the arm that listens"}, to);
    parameter({"weight", "", 0, 1e3, "eps_ij of (1.9); 0: not used"}, weight);
  }
};

struct PinLayout : Pin {
  void Visit(ParameterVisitor& parameter) {
    parameter({"arm", "", 1, kMaxArms, "id of an arm that hears the leader"}, arm);
    parameter({"weight", "", 0, 1e3, "b_i of (1.9); 0: not used"}, weight);
  }
};

struct GraphLayout {
  std::vector<PinLayout> pins;
  std::vector<EdgeLayout> edges;

  void Visit(ParameterVisitor& parameter) {
    parameter.List({"pins", "an arm that hears the leader; `pins = [1, 3]` is short for weights of 1"}, pins);
    parameter.List({"edges", "one arm that listens to another"}, edges);
  }
};

struct ArmLayout {
  int id = 0;
  std::string bus;
  CanBusConfig can;
  DriveProfile drive = DriveProfile::kODriveCanSimple;
  JointVector torque_limit_Nm;
  double watchdog_s = JointDriveConfig().watchdog_s;
  int bring_up_attempts = JointDriveConfig().bring_up_attempts;
  ODriveConfig odrive;
  MitConfig mit;
  Cia402Config cia402;
  MoteusConfig moteus;
  PlanarArmConfig arm;
  std::vector<LinkConfig> link;
  std::vector<ObstacleConfig> obstacle;
  std::vector<JointDriveConfig> joint;
  ControlConfig control;

  void Visit(ParameterVisitor& parameter) {
    parameter({"id", "", 1, kMaxArms, "number of the arm, unique in the fleet"}, id);
    parameter({"bus", "", 0, 0, "arm's own CAN bus: udp:GROUP:PORT or socketcan:INTERFACE"}, bus);
    parameter.Table("can", can);
    parameter({"drive", "", 0, 0, "profile that the arm's drives speak, unless a joint says otherwise"},
              drive);
    parameter({"torque_limit_Nm", "N m", 1e-3, 1e5, "largest torque of a joint: one value, or one a joint"},
              torque_limit_Nm);
    parameter({"watchdog_s", "s", 0.005, 10, "silence after which a drive must stop by itself"}, watchdog_s);
    parameter({"bring_up_attempts", "", 1, 100,
               "times that a step of a drive's bring-up is tried before the drive counts as failed"},
              bring_up_attempts);
    parameter.Table("odrive", odrive);
    parameter.Table("mit", mit);
    parameter.Table("cia402", cia402);
    parameter.Table("moteus", moteus);
    arm.Visit(parameter);
    parameter.List({"link", "a link, 1 to 7 from the base outwards"}, link, [](size_t) {
      return LinkConfig{0.0, 0.0, 0.0, 0.0};
    });  // none has a default
    parameter.List({"obstacle", "a thing at rest that the arm's links keep from by spare joints, at most 8"},
                   obstacle);
    parameter.List(
        {"joint",
         "wiring of a joint, one a link; what is left out: node ids 1, 2, .., and what the arm says "
         "for all"},
        joint, [this](size_t i) { return JointPrototype(i); });
    parameter.Table("control", control);
  }

  /// Joint i, from 0, where the file says nothing of it. Its torque limit is NaN if the arm gives none for
  /// it.
  JointDriveConfig JointPrototype(size_t i) const;
};

struct FleetLayout {
  std::string name;
  double topology_period_s = 0.0;
  TimingConfig timing;
  EstimatorConfig estimator;
  LcmLinkConfig link;
  ControlConfig control;
  bool each_arm_has_all_control = false;  ///< in a written file: the fleet-wide table is left out
  std::vector<ArmLayout> arm;
  std::vector<GraphLayout> graph;

  void Visit(ParameterVisitor& parameter) {
    parameter({"name", "", 0, 0, "name of the fleet"}, name);
    parameter({"topology_period_s", "s", 0, 1e6, "time for which each of several [[graph]] is used in turn"},
              topology_period_s);
    parameter.Table("timing", timing);
    parameter.Table("estimator", estimator);
    parameter.Table("link", link);
    if (!each_arm_has_all_control) parameter.Table("control", control);
    parameter.List({"arm", "an arm of the fleet, 1 to 64"}, arm, [this](size_t) {
      ArmLayout prototype;
      prototype.control = control;
      return prototype;
    });
    parameter.List({"graph", "a topology, 1 to 16; several take turns"}, graph);
  }
};

/// What a file that passed CheckFleet means.
FleetConfig FleetOf(const FleetLayout& layout, const std::string& file);

/// The file that means this.
FleetLayout LayoutOf(const FleetConfig& fleet);

/// The arm's geometry, masses, limits and obstacles. @pre at most kMaxDof links and kMaxObstacles obstacles.
PlanarArmConfig PlanarArmOf(const ArmLayout& layout);

}  // namespace armada
