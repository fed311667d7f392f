#include "firmware/core/adaptation.h"

#include <Eigen/Cholesky>

namespace armada {

TorqueResidual ResidualOf(const PlanarArm& arm, const ParameterVector& theta_hat,
                          const AppliedInterval& interval) {
  const JointVector q_mid = 0.5 * (interval.q_start_rad + interval.q_end_rad);
  TorqueResidual residual{arm.At(q_mid), 0.5 * (interval.dq_start_rad_s + interval.dq_end_rad_s), {}, {}};
  const JointMatrix H_hat = arm.Inertia(residual.at, theta_hat);
  const JointVector u_minus_bias = interval.tau_Nm - arm.Bias(residual.at, residual.dq_mid_rad_s, theta_hat);
  residual.predicted_ddq_rad_s2 = H_hat.llt().solve(u_minus_bias);
  const JointVector ddq = (interval.dq_end_rad_s - interval.dq_start_rad_s) / interval.h_s;
  residual.z_Nm = H_hat * (ddq - residual.predicted_ddq_rad_s2);
  return residual;
}

ParameterFilter::ParameterFilter(const AdaptationConfig& config, const PlanarArm& arm) : config_(config) {
  const Eigen::Index count = arm.parameter_count();
  P_ = ParameterMatrix::Identity(count, count) * (config_.initial_deviation * config_.initial_deviation);
}

void ParameterFilter::Update(const PlanarArm& arm, const TorqueResidual& residual,
                             ParameterVector& theta_hat) {
  const RegressorMatrix Y =
      arm.Regressor(residual.at, residual.dq_mid_rad_s, residual.dq_mid_rad_s, residual.predicted_ddq_rad_s2);
  const RegressorMatrix YP = Y.lazyProduct(P_);
  JointMatrix S = YP.lazyProduct(Y.transpose());
  S.diagonal().array() += config_.torque_deviation_Nm * config_.torque_deviation_Nm;
  const auto S_factor = S.llt();
  const JointVector weighted = S_factor.solve(residual.z_Nm);
  theta_hat -= YP.transpose().lazyProduct(weighted);  // K z = P Y' S^-1 z
  const RegressorMatrix S_inverse_YP = S_factor.solve(YP);
  P_.noalias() -= YP.transpose().lazyProduct(S_inverse_YP);
  const ParameterMatrix P_transposed = P_.transpose();
  P_ = 0.5 * (P_ + P_transposed);  // symmetric against rounding
  P_.diagonal().array() += config_.drift_variance;
}

void GradientStep(const AdaptationConfig& config, const RegressorMatrix& Y, const JointVector& s, double h_s,
                  ParameterVector& theta_hat) {
  ParameterVector step = Y.transpose().lazyProduct(s);
  step *= h_s * config.gradient_T;
  const double length = step.norm();
  if (config.gradient_step_max > 0.0 && length > config.gradient_step_max)
    step *= config.gradient_step_max / length;
  theta_hat -= step;
}

}  // namespace armada
