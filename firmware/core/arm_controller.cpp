#include "firmware/core/arm_controller.h"

namespace armada {
namespace {

std::variant<RobustLaw, PaperLaw> MakeLaw(const ArmControllerConfig& config, const PlanarArm& arm,
                                          const ArmInitialState& initial) {
  if (config.control.law == LawKind::kPaper) return PaperLaw(config.control, arm, initial.theta_hat);
  return RobustLaw(config.control, arm, initial.theta_hat, config.torque_limit_Nm,
                   config.timing.sample_to_torque_s, initial.P_theta);
}

}  // namespace

ArmController::ArmController(const ArmControllerConfig& config, const ArmInitialState& initial)
    : config_(config),
      arm_(config.arm),
      estimator_(config.estimator, initial.zeta),
      law_(MakeLaw(config, arm_, initial)),
      gate_(config.torque_limit_Nm) {
  status_.x_m = TaskVector::Zero(PlanarArm::kTaskDim);
  status_.zeta = initial.zeta;
  status_.tau_Nm = JointVector::Zero(arm_.dof());
}

Zeta ArmController::StepEstimator(double tick_s, const Neighbours& neighbours) {
  const double h = config_.timing.period_s;
  const double since_valid_s = estimating_ ? tick_s - zeta_time_s_ : 0.0;
  const double missed_s = since_valid_s > 0.5 * h ? since_valid_s : 0.0;  // ticks were missed
  estimating_ = true;
  Zeta zeta_at_tick = Taylor(estimator_.zeta(), missed_s);
  estimator_.Update(neighbours, h, missed_s);
  zeta_time_s_ = tick_s + h;
  return zeta_at_tick;
}

JointVector ArmController::Step(const ArmInput& in) {
  const double h = config_.timing.period_s;
  const double elapsed_s = controlling_ ? in.sample_s - previous_sample_s_ : h;
  controlling_ = true;
  previous_sample_s_ = in.sample_s;

  // Networked algorithm (1.9): from t_k to t_k + h.
  const Zeta zeta_at_tick = StepEstimator(in.tick_s, in.neighbours);

  // Local algorithm (1.2), (1.5), (1.8) at the sample's time.
  const double sample_delay_s = in.sample_s - in.tick_s;
  const LawInput law_input{in.q_rad,
                           in.dq_rad_s,
                           Taylor(zeta_at_tick, sample_delay_s),
                           Taylor(estimator_.zeta(), sample_delay_s),
                           estimator_.synced(),
                           elapsed_s,
                           h};
  const JointVector wanted = std::visit([&](auto& law) { return law.Torque(law_input); }, law_);

  // Limits and gate come last.
  const JointVector sent = gate_.Update(wanted);
  if (auto* robust = std::get_if<RobustLaw>(&law_); robust != nullptr && !gate_.shut())
    robust->Applied(wanted, sent);

  status_.state = gate_.shut() ? ControllerState::kFault : ControllerState::kRun;
  status_.tau_Nm = sent;
  Observe(in, law_input.zeta);
  return sent;
}

void ArmController::Observe(const ArmInput& in, const Zeta& zeta) {
  const PlanarArm::Posture at = arm_.At(in.q_rad);
  const JacobianMatrix J = arm_.Jacobian(at);
  const Pseudoinverse inverse = DampedPseudoinverse(config_.control.pseudoinverse, J);
  status_.x_m = arm_.Position(at);
  status_.zeta = zeta;
  status_.error_m = (status_.x_m - zeta.x_m).norm();
  status_.sigma_min = inverse.sigma_min;
  status_.manipulability = inverse.determinant_JJt;
  if (arm_.dof() > PlanarArm::kTaskDim) {
    // The same for dq_r in place of phi: (I - J#J) J# = 0.
    const auto* robust = std::get_if<RobustLaw>(&law_);
    const JointVector wanted = robust != nullptr
                                   ? robust->dq_r_rad_s()
                                   : PrintedSubtaskVelocity(config_.control.subtask, arm_, in.q_rad, at, J);
    const JointVector difference = in.dq_rad_s - wanted;
    status_.subtask_error_rad_s = (difference - inverse.J_sharp * (J * difference)).norm();
  }
}

const ParameterVector& ArmController::theta_hat() const {
  return std::visit([](const auto& law) -> const ParameterVector& { return law.theta_hat(); }, law_);
}

ParameterMatrix ArmController::P_theta() const {
  const auto* robust = std::get_if<RobustLaw>(&law_);
  return robust != nullptr ? robust->P_theta() : ParameterMatrix();
}

JointVector ArmController::d_hat_Nm() const {
  const auto* robust = std::get_if<RobustLaw>(&law_);
  return robust != nullptr ? robust->d_hat_Nm() : JointVector(JointVector::Zero(arm_.dof()));
}

}  // namespace armada
