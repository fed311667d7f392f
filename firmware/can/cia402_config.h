#pragma once

#include "firmware/core/parameter.h"

namespace armada {

/// Units, timing and reactions of a CiA 402 drive.
struct Cia402Config {
  double counts_per_turn = 131072.0;      ///< position units of 6064h a motor turn
  double velocity_per_turn_s = 131072.0;  ///< 606Ch at one motor turn a second
  double rated_torque_Nm = 10.0;          ///< motor side, as the drive's 6076h says
  bool torque_of_max = false;             ///< 6071h and 6077h count thousandths of 6072h instead of 6076h
  int quick_stop = 2;                     ///< written to 605Ah
  int fault_reaction = 2;                 ///< written to 605Eh
  double heartbeat_s = 0.1;               ///< period of the drive's heartbeat and of the master's
  double heartbeat_timeout_s = 0.3;       ///< silence after which either holds the other to be lost
  int master_node_id = 127;               ///< the same for all drives of a bus
  double boot_timeout_s = 0.3;            ///< from a reset to the boot-up message; then it is reset again
  double sdo_timeout_s = 0.05;            ///< from a request to its answer; then it is asked again

  void Visit(ParameterVisitor& parameter) {
    parameter({"counts_per_turn", "", 1, 1e8, "position units (6064h) a motor turn"}, counts_per_turn);
    parameter({"velocity_per_turn_s", "", 1e-3, 1e8,
               "velocity units (606Ch) at one motor turn a second; 60 for a drive that counts in rpm"},
              velocity_per_turn_s);
    parameter({"rated_torque_Nm", "N m", 1e-3, 1e5,
               "rated torque of the motor, compared with the drive's (6076h); torques (6071h) are in 0.1 % "
               "of it"},
              rated_torque_Nm);
    parameter({"torque_of_max", "", 0, 1,
               "the drive counts torques (6071h) in 0.1 % of its maximum (6072h) instead of the rated one"},
              torque_of_max);
    parameter({"quick_stop", "", 0, 2,
               "how a quick stop brakes (605Ah): 0 not at all, 1 slow-down ramp, 2 quick-stop ramp"},
              quick_stop);
    parameter({"fault_reaction", "", 0, 2,
               "how a fault or a silent master brakes (605Eh): 0 not at all, 1 slow-down ramp, 2 quick-stop "
               "ramp"},
              fault_reaction);
    parameter({"heartbeat_s", "s", 0.01, 10, "period of the drive's heartbeat and of the master's"},
              heartbeat_s);
    parameter({"heartbeat_timeout_s", "s", 0.02, 60,
               "silence after which drive and master hold each other to be lost; above heartbeat_s"},
              heartbeat_timeout_s);
    parameter(
        {"master_node_id", "", 1, 127, "address of the master's heartbeat, one for all drives of a bus"},
        master_node_id);
    parameter({"boot_timeout_s", "s", 0.01, 60, "from a reset to the drive's boot-up message"},
              boot_timeout_s);
    parameter({"sdo_timeout_s", "s", 0.01, 10, "from an SDO request to its answer"}, sdo_timeout_s);
  }
};

}  // namespace armada
