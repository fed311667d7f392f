#pragma once

#include "firmware/can/cia402_config.h"
#include "firmware/can/drive_profile.h"
#include "firmware/can/mit_config.h"
#include "firmware/can/moteus_config.h"
#include "firmware/can/odrive_config.h"
#include "firmware/core/parameter.h"

namespace armada {

/// How a joint is wired to its drive. The codec converts; everything above it speaks joint-side SI units.
///   q = direction q_motor / gear_ratio + offset,  tau = direction gear_ratio tau_motor.
struct JointDriveConfig {
  DriveProfile profile = DriveProfile::kODriveCanSimple;
  int node_id = 0;               ///< drive's address on its bus
  double gear_ratio = 1.0;       ///< motor turns per joint turn, > 0
  double direction = 1.0;        ///< +1 or -1: sign of motor motion for positive joint motion
  double offset_rad = 0.0;       ///< joint angle at the drive's zero
  double torque_limit_Nm = 0.0;  ///< joint-side; the codec never encodes more
  /// Silence after which the drive stops by itself. Written to the drive where its protocol can; elsewhere it
  /// is what the drive was set to, and proved at bring-up.
  double watchdog_s = 0.03;
  int bring_up_attempts = 5;
  ODriveConfig odrive = {};  ///< profiles odrive_cansimple and odrive_cansimple_v05
  MitConfig mit = {};        ///< profiles mini_cheetah, cubemars and damiao
  Cia402Config cia402 = {};  ///< profile cia402
  MoteusConfig moteus = {};  ///< profile moteus

  void Visit(ParameterVisitor& parameter) {
    parameter({"drive", "", 0, 0, "profile that the drive speaks"}, profile);
    parameter({"node_id", "", 0, 127, "address of the drive on the arm's bus"}, node_id);
    parameter({"gear_ratio", "", 1e-3, 1e4, "motor turns per joint turn"}, gear_ratio);
    parameter({"direction", "", -1, 1, "+1 or -1, sign of motor motion for positive joint motion"},
              direction);
    parameter({"offset_rad", "rad", -1e3, 1e3, "joint angle at the drive's zero"}, offset_rad);
    parameter({"torque_limit_Nm", "N m", 1e-3, 1e5, "largest torque at the joint"}, torque_limit_Nm);
    parameter({"watchdog_s", "s", 0.005, 10, "silence after which the drive must stop by itself"},
              watchdog_s);
    parameter({"bring_up_attempts", "", 1, 100,
               "times that a step of the drive's bring-up is tried before the drive counts as failed"},
              bring_up_attempts);
    parameter.Table("odrive", odrive);
    parameter.Table("mit", mit);
    parameter.Table("cia402", cia402);
    parameter.Table("moteus", moteus);
  }
};

}  // namespace armada
