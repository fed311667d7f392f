#pragma once

#include <Eigen/LU>

#include "hil/leader_path.h"
#include "hil/start_state.h"
#include "tests/closed_loop/simulate.h"
#include "tests/support/random_arms.h"

namespace armada {

/// One arm of a scenario as the paper's proofs have it: the leader's state known exactly, no latency, no
/// limit of torque. What is left of the real world is the sampling; the plant integrates a step a tick.
class IdealArm {
 public:
  /// The arm and its start are those of `scenario` and `seed`, sampled every `h_s`.
  IdealArm(const ScenarioConfig& scenario, size_t index, uint64_t seed, double h_s)
      : leader_(scenario.leader),
        control_(scenario.fleet.arms[index].control),
        arm_(scenario.fleet.arms[index].arm),
        plant_(scenario.fleet.arms[index].arm),
        law_(control_, arm_, Begin(DrawStart(scenario, index, seed, &leader_))),
        h_s_(h_s),
        s_(SlidingVariable()) {}

  double time_s() const { return static_cast<double>(tick_) * h_s_; }
  JointVector q_rad() const { return FromPlant(plant_, plant_.q_rad); }
  JointVector dq_rad_s() const { return FromPlant(plant_, plant_.dq_rad_s); }

  /// s of (1.3)
  const JointVector& s_rad_s() const { return s_; }

  /// V_i1 = (s'H s + theta~' T^-1 theta~) / 2 of the proof of Theorem 2, J.
  double Storage() const {
    const ParameterVector theta = arm_.Theta();
    const double kinetic = s_.dot(arm_.Inertia(arm_.At(q_rad()), theta) * s_);
    return 0.5 * (kinetic + (law_.theta_hat() - theta).squaredNorm() / control_.adaptation.gradient_T);
  }

  /// dV_i1/dt as the proof has it: -s'(K_s + J'K_x J) s - s'K_r sgn(s) - s'd, W.
  double StorageRate(const JointVector& d_Nm) const {
    const GainsConfig& gains = control_.gains;
    const TaskVector Js = arm_.Jacobian(arm_.At(q_rad())) * s_;
    return -s_.dot(gains.K_s_Nms_rad.cwiseProduct(s_)) - Js.dot(gains.K_x_Ns_m.cwiseProduct(Js)) -
           s_.cwiseAbs().dot(gains.K_r_Nm) - s_.dot(d_Nm);
  }

  /// |x - x_0|
  double error_m() const { return (arm_.Position(arm_.At(q_rad())) - leader_.At(time_s()).x_m).norm(); }

  /// One tick under the disturbance d of (1.1).
  void Tick(const JointVector& d_Nm) {
    const Zeta leader = leader_.At(time_s());
    const JointVector u_Nm = law_.Torque({q_rad(), dq_rad_s(), leader, leader, true, h_s_, h_s_});
    plant_.Step(ToPlant(u_Nm - d_Nm), h_s_);
    ++tick_;
    s_ = SlidingVariable();
  }

 private:
  JointVector SlidingVariable() const {
    const JointVector q = q_rad();
    const PlanarArm::Posture at = arm_.At(q);
    const JacobianMatrix J = arm_.Jacobian(at);
    const Eigen::Matrix2d JJt = J * J.transpose();
    const Zeta leader = leader_.At(time_s());
    const JointVector phi = PrintedSubtaskVelocity(control_.subtask, arm_, q, at, J);
    const TaskVector r = leader.v_m_s - control_.paper.alpha_1_s * (arm_.Position(at) - leader.x_m) - J * phi;
    return dq_rad_s() - phi - J.transpose() * (JJt.inverse() * r);
  }

  ParameterVector Begin(const ArmStart& start) {
    plant_.q_rad = start.q_rad;
    plant_.dq_rad_s = start.dq_rad_s;
    return start.controller.theta_hat;
  }

  LeaderPath leader_;
  ControlConfig control_;
  PlanarArm arm_;
  PlanarPlant plant_;
  PaperLaw law_;
  double h_s_;
  int tick_ = 0;
  JointVector s_;
};

}  // namespace armada
