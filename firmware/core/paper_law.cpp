#include "firmware/core/paper_law.h"

#include <Eigen/LU>

namespace armada {

JointVector PaperLaw::Torque(const LawInput& in) {
  const JointVector& q = in.q_rad;
  const JointVector& dq = in.dq_rad_s;
  const PlanarArm::Posture at = arm_.At(q);
  const JacobianMatrix J = arm_.Jacobian(at);
  const JacobianMatrix dJ = arm_.JacobianRate(at, dq);
  const TaskVector x = arm_.Position(at);
  const TaskVector dx = J * dq;

  // J# and its derivative: M = (J J')^-1, J# = J'M, dJ#/dt = dJ'M + J'dM.
  const Eigen::Matrix2d JJt = J * J.transpose();
  const Eigen::Matrix2d dJJt = dJ * J.transpose() + J * dJ.transpose();
  const Eigen::Matrix2d M = JJt.inverse();
  const Eigen::Matrix2d dM = -M * dJJt * M;
  const InverseMatrix J_sharp = J.transpose() * M;
  const InverseMatrix dJ_sharp = dJ.transpose() * M + J.transpose() * dM;

  const double alpha = config_.paper.alpha_1_s;
  const TaskVector r = in.zeta.v_m_s - alpha * (x - in.zeta.x_m);
  JointVector dq_r = J_sharp * r;                                                                // (1.5)
  JointVector ddq_r = dJ_sharp * r + J_sharp * (in.zeta.a_m_s2 - alpha * (dx - in.zeta.v_m_s));  // (1.6)
  if (arm_.dof() > PlanarArm::kTaskDim && config_.subtask.kind != SubtaskKind::kNone) {
    const auto phi_at = [&](const JointVector& q_at) {
      const PlanarArm::Posture posture = arm_.At(q_at);
      return PrintedSubtaskVelocity(config_.subtask, arm_, q_at, posture, arm_.Jacobian(posture));
    };
    const JointVector phi = phi_at(q);
    const double step_s = config_.paper.difference_s;
    const JointVector dphi = (phi_at(q + step_s * dq) - phi_at(q - step_s * dq)) / (2.0 * step_s);
    dq_r += phi - J_sharp * (J * phi);
    ddq_r += dphi - J_sharp * (J * dphi) - dJ_sharp * (J * phi) - J_sharp * (dJ * phi);
  }

  const JointVector s = dq - dq_r;
  const RegressorMatrix Y = arm_.Regressor(at, dq, dq_r, ddq_r);
  const JointVector sign_s = s.cwiseSign();
  const GainsConfig& K = config_.gains;
  JointVector u = Y.lazyProduct(theta_hat_);
  u -= in.gain_share * (J.transpose() * K.K_x_Ns_m.cwiseProduct(J * s) + K.K_s_Nms_rad.cwiseProduct(s));
  u -= K.K_r_Nm.cwiseProduct(sign_s);  // (1.2)

  if (in.adapts)
    theta_hat_ -= (in.period_s * config_.adaptation.gradient_T) * Y.transpose().lazyProduct(s);  // (1.8)
  return u;
}

}  // namespace armada
