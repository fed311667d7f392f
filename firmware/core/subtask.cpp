#include "firmware/core/subtask.h"

namespace armada {

JointVector ManipulabilityGradient(const PlanarArm& arm, const PlanarArm::Posture& at,
                                   const JacobianMatrix& J) {
  const Eigen::Matrix2d JJt = J.lazyProduct(J.transpose());
  Eigen::Matrix2d adjugate;
  adjugate << JJt(1, 1), -JJt(0, 1), -JJt(1, 0), JJt(0, 0);
  const JacobianMatrix weighted = adjugate * J;  // d det(G) = tr(adj(G) dG), dG = dJ J' + J dJ'
  JointVector gradient(arm.dof());
  for (int k = 0; k < arm.dof(); ++k) {
    const JacobianMatrix dJ = arm.JacobianRate(at, JointVector::Unit(arm.dof(), k));
    gradient[k] = 2.0 * weighted.cwiseProduct(dJ).sum();
  }
  return gradient;
}

JointVector SubtaskVelocity(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q,
                            const PlanarArm::Posture& at, const JacobianMatrix& J) {
  JointVector phi = JointVector::Zero(arm.dof());
  switch (config.kind) {
    case SubtaskKind::kNone:
      return phi;
    case SubtaskKind::kPosture:
      phi[config.joint - 1] = config.gain * (config.goal_rad - q[config.joint - 1]);
      break;
    case SubtaskKind::kManipulability:
      phi = config.gain * ManipulabilityGradient(arm, at, J);
      break;
  }
  const double largest = phi.cwiseAbs().maxCoeff();
  if (config.phi_max_rad_s > 0.0 && largest > config.phi_max_rad_s) phi *= config.phi_max_rad_s / largest;
  return phi;
}

}  // namespace armada
