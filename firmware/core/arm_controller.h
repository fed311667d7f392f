#pragma once

#include <variant>

#include "firmware/core/control_config.h"
#include "firmware/core/estimator.h"
#include "firmware/core/limits.h"
#include "firmware/core/motion_watch.h"
#include "firmware/core/paper_law.h"
#include "firmware/core/parameter.h"
#include "firmware/core/robust_law.h"
#include "firmware/core/stop_law.h"
#include "firmware/core/supervisor.h"

namespace armada {

struct TimingConfig {
  double period_s = 0.01;
  double sample_to_torque_s = 0.001;
  double bring_up_s = 1.0;
  double feedback_timeout_s = 0.003;
  double feedback_stale_s = 0.025;
  double transmit_timeout_s = 0.002;
  int transmit_failures_max = 2;
  int listens = 4;

  void Visit(ParameterVisitor& parameter) {
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
    parameter({"listens", "", 1, 100,
               "times a period that a board takes the messages that wait: the more, the less of the kernel's "
               "queue a storm can fill, and the less of it is left between sample and torque"},
              listens);
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
  bool samples_valid = true;     ///< q and dq are of now, or predicted
  bool samples_good = false;     ///< for control.supervisor.good_samples without a break
  bool neighbours_good = false;  ///< the same
  bool drives_ready = true;      ///< found and configured
  bool drives_enabled = true;    ///< all in torque mode
  CauseSet causes;               ///< of the board: its drives, buses and timing
  Request request = Request::kNone;
};

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
  ArmController(const ArmControllerConfig& config, const ArmInitialState& initial, StartMode start);

  /// One tick: estimator (1.9), law (1.2) with reference (1.5) and adaptation (1.8), supervisor, limits.
  /// Torque to send, N m; zero, and not to be sent, where the state gives none.
  JointVector Step(const ArmInput& in);

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
  const Supervisor& supervisor() const { return supervisor_; }
  ControllerState state() const { return supervisor_.state(); }
  /// Nobody is heard any more who knows of the leader.
  bool leader_lost() const { return leader_lost_; }
  const PlanarArm& arm() const { return arm_; }

 private:
  /// (1.9) from the tick to the next; returns zeta at the tick.
  Zeta StepEstimator(double tick_s, const Neighbours& neighbours);
  bool LosesTheLeader(const Neighbours& neighbours);
  bool LawRuns(const ArmInput& in) const;
  JointVector LawTorque(const ArmInput& in, const Zeta& zeta_at_sample);
  JointVector TorqueOf(ControllerState state, const JointVector& law_Nm, const ArmInput& in);
  void Observe(const ArmInput& in, const Zeta& zeta);
  /// After a reset: what was learnt stays, as far as it is a number.
  void StartAnew();

  ArmControllerConfig config_;
  PlanarArm arm_;
  Estimator estimator_;
  ArmInitialState initial_;
  std::variant<RobustLaw, PaperLaw> law_;
  HoldLaw hold_law_;
  MotionWatch watch_;
  Supervisor supervisor_;
  TorqueGate gate_;
  ArmStatus status_;
  bool estimating_ = false;
  bool controlling_ = false;
  bool ever_synced_ = false;
  bool leader_lost_ = false;
  double zeta_time_s_ = 0.0;
  double previous_sample_s_ = 0.0;
};

}  // namespace armada
