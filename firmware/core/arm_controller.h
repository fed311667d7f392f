#pragma once

#include <variant>

#include "firmware/core/control_config.h"
#include "firmware/core/estimator.h"
#include "firmware/core/limits.h"
#include "firmware/core/paper_law.h"
#include "firmware/core/robust_law.h"

namespace armada {

struct TimingConfig {
  double period_s = 0.01;
  double sample_to_torque_s = 0.001;
  double bring_up_s = 1.0;
  double feedback_timeout_s = 0.003;
  double feedback_stale_s = 0.025;
  double transmit_timeout_s = 0.002;
  int transmit_failures_max = 2;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"period_s", "s", 1e-4, 1, "control period h"}, period_s);
    parameter(
        {"sample_to_torque_s", "s", 0, 1,
         "delay from the joint sample to the torque's effect, which the law compensates; below the period"},
        sample_to_torque_s);
    parameter({"bring_up_s", "s", 0.1, 60, "time before the first tick in which the drives are brought up"},
              bring_up_s);
    parameter({"feedback_timeout_s", "s", 1e-5, 1,
               "time a tick waits for the joints' samples; a missing one is then predicted"},
              feedback_timeout_s);
    parameter({"feedback_stale_s", "s", 1e-4, 1, "age of a joint's sample at which the arm is disabled"},
              feedback_stale_s);
    parameter({"transmit_timeout_s", "s", 1e-5, 1,
               "time that a tick waits for its torques to be on the wire; those that are not are dropped"},
              transmit_timeout_s);
    parameter({"transmit_failures_max", "ticks", 1, 100,
               "ticks in a row whose torques did not get out at which the arm is disabled"},
              transmit_failures_max);
  }
};

struct ArmControllerConfig {
  TimingConfig timing;
  PlanarArmConfig arm;
  EstimatorConfig estimator;
  ControlConfig control;
  JointVector torque_limit_Nm;
};

/// What is not configuration but the start of an arm's state: zeta_i(0) and theta_hat_i(0).
struct ArmInitialState {
  Zeta zeta;
  ParameterVector theta_hat;
  ParameterMatrix P_theta{};  ///< covariance of theta_hat, p x p; empty: adaptation.initial_deviation
};

/// What one tick sees. `tick_s` lies on the period's grid; the sample was taken at `sample_s`, at or after
/// it.
struct ArmInput {
  double tick_s = 0.0;
  double sample_s = 0.0;
  JointVector q_rad;
  JointVector dq_rad_s;
  Neighbours neighbours;
};

enum class ControllerState : int { kInit = 0, kRun = 1, kFault = 2 };

constexpr const char* NameOf(ControllerState state) {
  switch (state) {
    case ControllerState::kInit:
      return "INIT";
    case ControllerState::kRun:
      return "RUN";
    case ControllerState::kFault:
      break;
  }
  return "FAULT";
}

/// What a tick leaves for people and for the record.
struct ArmStatus {
  ControllerState state = ControllerState::kInit;
  TaskVector x_m;                    ///< end effector at the sample
  double error_m = 0.0;              ///< |x - x_hat|
  double subtask_error_rad_s = 0.0;  ///< |e_s| = |(I - J#J)(dq - phi)|; 0 for an arm without spare joints
  double sigma_min = 0.0;            ///< m/rad
  double manipulability = 0.0;       ///< det(J J')
  JointVector tau_Nm;                ///< sent
  Zeta zeta;                         ///< estimate used, at the sample
};

/// The controller of one arm: one Step a period, the same in simulation and on a board. Fixed memory.
class ArmController {
 public:
  ArmController(const ArmControllerConfig& config, const ArmInitialState& initial);

  /// One tick: estimator (1.9), law (1.2) with reference (1.5) and adaptation (1.8), limits, gate. Torque to
  /// send, N m.
  JointVector Step(const ArmInput& in);
  /// The networked algorithm (1.9) alone, for a tick in which the arm itself is out of action: neighbours
  /// still need the estimate. Returns zeta at the tick.
  Zeta StepEstimator(double tick_s, const Neighbours& neighbours);

  /// The state that neighbours may use, valid at `zeta_time_s()` on the clock of ArmInput.
  const Zeta& zeta() const { return estimator_.zeta(); }
  double zeta_time_s() const { return zeta_time_s_; }
  const Estimator& estimator() const { return estimator_; }
  const ParameterVector& theta_hat() const;
  /// Covariance of theta_hat, p x p; empty where the law knows of none.
  ParameterMatrix P_theta() const;
  JointVector d_hat_Nm() const;
  int saturated_ticks() const { return gate_.saturated_ticks(); }
  const ArmStatus& status() const { return status_; }
  const PlanarArm& arm() const { return arm_; }

 private:
  void Observe(const ArmInput& in, const Zeta& zeta);

  ArmControllerConfig config_;
  PlanarArm arm_;
  Estimator estimator_;
  std::variant<RobustLaw, PaperLaw> law_;
  TorqueGate gate_;
  ArmStatus status_;
  bool estimating_ = false;
  bool controlling_ = false;
  double zeta_time_s_ = 0.0;
  double previous_sample_s_ = 0.0;
};

}  // namespace armada
