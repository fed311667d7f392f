#include "firmware/core/arm_controller.h"

#include <limits>

namespace armada {
namespace {

std::variant<RobustLaw, PaperLaw> MakeLaw(const ArmControllerConfig& config, const PlanarArm& arm,
                                          const ArmInitialState& initial) {
  if (config.control.law == LawKind::kPaper) return PaperLaw(config.control, arm, initial.theta_hat);
  return RobustLaw(config.control, arm, initial.theta_hat, config.torque_limit_Nm,
                   config.timing.sample_to_torque_s, initial.P_theta);
}

// The printed law comes no nearer than a few centimetres, and is to be seen doing so.
SupervisorConfig WatchConfig(const ControlConfig& control) {
  SupervisorConfig config = control.supervisor;
  if (control.law == LawKind::kPaper) config.follow_max_s = std::numeric_limits<double>::infinity();
  return config;
}

}  // namespace

ArmController::ArmController(const ArmControllerConfig& config, const ArmInitialState& initial,
                             StartMode start)
    : config_(config),
      arm_(config.arm),
      estimator_(config.estimator, initial.zeta),
      initial_(initial),
      law_(MakeLaw(config, arm_, initial)),
      hold_law_(config.control.supervisor),
      watch_(WatchConfig(config.control), config.arm),
      supervisor_(config.control.supervisor, start),
      gate_(config.torque_limit_Nm) {
  status_.x_m = TaskVector::Zero(PlanarArm::kTaskDim);
  status_.zeta = initial.zeta;
  status_.tau_Nm = JointVector::Zero(arm_.dof());
}

JointVector ArmController::Step(const ArmInput& in) {
  const double h = config_.timing.period_s;

  // Networked algorithm (1.9): from t_k to t_k + h.
  const Zeta zeta_at_tick = StepEstimator(in.tick_s, in.neighbours);
  const Zeta zeta = Taylor(zeta_at_tick, in.sample_s - in.tick_s);

  // Local algorithm (1.2), (1.5), (1.8) at the sample's time.
  const bool law_runs = LawRuns(in);
  const JointVector law_Nm = law_runs ? LawTorque(in, zeta) : JointVector(JointVector::Zero(arm_.dof()));
  if (in.samples_valid) Observe(in, zeta);

  // Supervisor: what is wrong, and what that makes of the state.
  const ControllerState before = supervisor_.state();
  CauseSet causes = in.causes;
  causes.Set(Cause::kFeedbackNonsense, !in.q_rad.allFinite() || !in.dq_rad_s.allFinite());
  causes.Set(Cause::kNonFiniteTorque, !law_Nm.allFinite() || !gate_.finite());
  causes.Set(Cause::kLeaderLost, LosesTheLeader(in.neighbours));
  causes |= watch_.Update({in.q_rad, status_.error_m, status_.sigma_min, gate_.saturated(), Follows(before),
                           before == ControllerState::kHold, estimator_.synced()},
                          h);
  const ControllerState state = supervisor_.Step(
      {causes, in.request, in.drives_ready, in.drives_enabled, in.samples_valid, in.samples_good,
       in.neighbours_good, estimator_.synced(), in.dq_rad_s.cwiseAbs().maxCoeff()},
      h);

  // Its gate and the limits come last.
  const JointVector sent_Nm = gate_.Update(TorqueOf(state, law_Nm, in));
  if (auto* robust = std::get_if<RobustLaw>(&law_); robust != nullptr && law_runs && law_Nm.allFinite())
    robust->Applied(law_Nm, sent_Nm);
  if (state != before && state == ControllerState::kInit) StartAnew();
  status_.state = state;
  status_.tau_Nm = sent_Nm;
  return sent_Nm;
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

// A neighbour whose news of the leader are older than this arm's has them from this arm, or no path of use.
bool ArmController::LosesTheLeader(const Neighbours& neighbours) {
  if (config_.estimator.leaderless) return false;
  ever_synced_ = ever_synced_ || estimator_.synced();
  const double own_age_s = estimator_.leader_age_s() - 0.5 * config_.timing.period_s;
  bool has_path = neighbours.switching;
  for (int j = 0; j < neighbours.count; ++j) {
    const Neighbour& neighbour = neighbours.list[static_cast<size_t>(j)];
    has_path = has_path || (neighbour.heard && !neighbour.silent && neighbour.leader_age_s <= own_age_s);
  }
  leader_lost_ = ever_synced_ && (!has_path || estimator_.leader_age_s() > config_.estimator.age_max_s);
  return leader_lost_;
}

// From the tick on in which the drives are enabled; after a stop only once it is started anew.
bool ArmController::LawRuns(const ArmInput& in) const {
  return in.samples_valid && in.drives_enabled && supervisor_.state() != ControllerState::kSafeStop &&
         supervisor_.state() != ControllerState::kFault;
}

JointVector ArmController::LawTorque(const ArmInput& in, const Zeta& zeta_at_sample) {
  const double h = config_.timing.period_s;
  const double elapsed_s = controlling_ ? in.sample_s - previous_sample_s_ : h;
  controlling_ = true;
  previous_sample_s_ = in.sample_s;
  const bool degraded = supervisor_.state() == ControllerState::kDegraded;
  const LawInput law_input{in.q_rad,
                           in.dq_rad_s,
                           zeta_at_sample,
                           Taylor(estimator_.zeta(), in.sample_s - in.tick_s),
                           estimator_.synced(),
                           elapsed_s,
                           h,
                           !degraded,
                           supervisor_.halves_gains() ? 0.5 : 1.0};
  return std::visit([&](auto& law) { return law.Torque(law_input); }, law_);
}

JointVector ArmController::TorqueOf(ControllerState state, const JointVector& law_Nm, const ArmInput& in) {
  const StopLawInput stop{in.q_rad, in.dq_rad_s, theta_hat(), config_.timing.period_s};
  const JointVector& K_s = config_.control.gains.K_s_Nms_rad;
  const auto damping = [&] {
    return DampingTorque(arm_, config_.control.supervisor.safe_stop_damping * K_s, stop);
  };
  if (state != ControllerState::kHold && state != ControllerState::kArming) hold_law_.Restart();
  switch (state) {
    case ControllerState::kRun:
    case ControllerState::kDegraded: {
      const double share = supervisor_.law_share();
      return share < 1.0 ? JointVector(share * law_Nm + (1.0 - share) * damping()) : law_Nm;
    }
    case ControllerState::kArming:
    case ControllerState::kHold:
      return hold_law_.Torque(arm_, K_s, stop);
    case ControllerState::kSafeStop:
      return damping();
    case ControllerState::kInit:
    case ControllerState::kMonitor:
    case ControllerState::kFault:
      break;
  }
  return JointVector::Zero(arm_.dof());
}

void ArmController::StartAnew() {
  if (theta_hat().allFinite()) {
    const ParameterMatrix P = P_theta();
    initial_.theta_hat = theta_hat();
    if (P.allFinite()) initial_.P_theta = P;
  }
  law_ = MakeLaw(config_, arm_, initial_);
  controlling_ = false;
  const Zeta& zeta = estimator_.zeta();
  if (!zeta.x_m.allFinite() || !zeta.v_m_s.allFinite() || !zeta.a_m_s2.allFinite())
    estimator_ = Estimator(config_.estimator, initial_.zeta);
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
