#include "host/arm_table.h"

#include <cstdio>
#include <ostream>

#include "firmware/core/named_enum.h"
#include "host/number_format.h"

namespace armada {

void PrintArmTable(const RunMetrics& metrics, std::ostream& out) {
  char line[240];
  const bool floor = metrics.floor_rms_m.has_value();
  out << "arm  joints  settled_s   rms_mm   max_mm  " << (floor ? "floor_mm  ratio  " : "")
      << "est_x_mm  torque_Nm  saturated  theta_err  subtask  state\n";
  for (const ArmMetrics& arm : metrics.arms) {
    const std::string settled = arm.settled_s ? NumberAs("%.2f", *arm.settled_s) : "never";
    std::string state = arm.faults.empty() ? arm.state : arm.state + " (" + arm.faults.front() + ")";
    if (arm.standing)
      state += ", to stand still: at most " + NumberAs("%.2f", arm.joint_speed_max_rad_s) + " rad/s";
    const std::string subtask = arm.subtask_rms_rad_s ? NumberAs("%.3f", *arm.subtask_rms_rad_s) : "-";
    const std::string above = arm.floor_rms_m ? NumberAs("%8.3f  ", *arm.floor_rms_m * 1e3) +
                                                    NumberAs("%5.2f  ", arm.rms_m / *arm.floor_rms_m)
                              : floor ? "       -      -  "
                                      : "";
    std::snprintf(line, sizeof line, "%3d  %6d  %9s  %7.3f  %7.3f  %s%8.2g  %9.1f  %9d  %9.3f  %7s  %s%s\n",
                  arm.id, arm.dof, settled.c_str(), arm.rms_m * 1e3, arm.max_m * 1e3, above.c_str(),
                  arm.estimator_rms.x_m * 1e3, arm.torque_max_Nm, arm.saturated_ticks, arm.parameter_error,
                  subtask.c_str(), state.c_str(), arm.diverged ? " DIVERGED" : "");
    out << line;
  }
  const std::string above =
      floor ? NumberAs(", %.2f times the floor of ", metrics.fleet_rms_m / *metrics.floor_rms_m) +
                  NumberAs("%.3f mm,", *metrics.floor_rms_m * 1e3)
            : "";
  std::snprintf(line, sizeof line, "%s: fleet RMS %.3f mm%s over %g-%g s, law %s, estimator %s, seed %llu\n",
                metrics.ok ? "ok" : "NOT ok", metrics.fleet_rms_m * 1e3, above.c_str(),
                metrics.window_start_s, metrics.seconds, std::string(NameOf(metrics.law)).c_str(),
                std::string(NameOf(metrics.estimator)).c_str(),
                static_cast<unsigned long long>(metrics.seed));
  out << line;
}

}  // namespace armada
