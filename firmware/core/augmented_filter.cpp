#include "firmware/core/augmented_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace armada {
namespace {

double Square(double value) {
  return value * value;
}

}  // namespace

AugmentedFilter::AugmentedFilter(const SensorConfig& sensor, const DisturbanceModelConfig& disturbance,
                                 const AdaptationConfig& adaptation, const ParameterMatrix& P_theta,
                                 const PlanarArm& arm)
    : sensor_(sensor),
      disturbance_(disturbance),
      theta_drift_variance_(P_theta.isZero() ? 0.0 : adaptation.drift_variance),
      second_order_(adaptation.second_order),
      joints_{JointVector::Zero(arm.dof()), JointVector::Zero(arm.dof())},
      d_hat_Nm_(JointVector::Zero(arm.dof())) {
  const Eigen::Index n = arm.dof();
  const Eigen::Index p = arm.parameter_count();
  P_xx_.setZero(2 * n, 2 * n);
  P_xb_.setZero(2 * n, p + n);
  P_bb_.setZero(p + n, p + n);
  P_bb_.topLeftCorner(p, p) = P_theta;
  if (disturbance_.drift_Nm > 0.0) P_bb_.diagonal().tail(n).setConstant(Square(disturbance_.bound_Nm) / 3.0);
}

void AugmentedFilter::Start(const JointState& sample) {
  const Eigen::Index n = sample.q_rad.size();
  joints_ = sample;
  P_xx_.setZero();
  P_xx_.diagonal().head(n) = sensor_.position_deviation_rad.cwiseAbs2();
  // An unbounded uncertainty of dq would take the digits of that of q in the first update.
  P_xx_.diagonal().tail(n) = sensor_.velocity_deviation_rad_s.cwiseMin(sensor_.start_speed_rad_s).cwiseAbs2();
}

void AugmentedFilter::Update(const PlanarArm& arm, const Applied& applied, const JointState& sample,
                             double elapsed_s, ParameterVector& theta_hat) {
  const JointState predicted = Predict(arm, theta_hat, applied, elapsed_s);
  PredictCovariance(arm, theta_hat, predicted, sample.dq_rad_s, elapsed_s);
  const UnknownVector db = Correct(predicted, sample);
  theta_hat += db.head(arm.parameter_count());
  d_hat_Nm_ += db.tail(arm.dof());
  // The likeliest state within the bounds: with each component of d that is brought back to its bound, theta
  // moves by what the covariance makes of that.
  const Eigen::Index p = arm.parameter_count();
  for (Eigen::Index i = 0; i < arm.dof(); ++i) {
    const double bounded_Nm = std::clamp(d_hat_Nm_[i], -disturbance_.bound_Nm, disturbance_.bound_Nm);
    const double variance = P_bb_(p + i, p + i);
    if (bounded_Nm == d_hat_Nm_[i] || variance <= 0.0) continue;
    const UnknownVector back = P_bb_.col(p + i) * ((bounded_Nm - d_hat_Nm_[i]) / variance);
    theta_hat += back.head(p);
    d_hat_Nm_ += back.tail(arm.dof());
  }
  d_hat_Nm_ = d_hat_Nm_.cwiseMax(-disturbance_.bound_Nm).cwiseMin(disturbance_.bound_Nm);
}

JointState AugmentedFilter::Predict(const PlanarArm& arm, const ParameterVector& theta_hat,
                                    const Applied& applied, double elapsed_s) const {
  const double before_s = std::min(applied.before_s, elapsed_s);
  JointState state = joints_;
  if (before_s > 0.0) state = Integrate(arm, theta_hat, state, applied.before_Nm - d_hat_Nm_, before_s);
  if (elapsed_s > before_s)
    state = Integrate(arm, theta_hat, state, applied.after_Nm - d_hat_Nm_, elapsed_s - before_s);
  return state;
}

// With v = h H^-1 (..) the change of dq over the interval, x+ = [q + h dq + h v / 2; dq + v]: F = [I, h I; 0,
// I] on x and L = [h/2 I; I] on v. What v changes with x is left out.
void AugmentedFilter::PredictCovariance(const PlanarArm& arm, const ParameterVector& theta_hat,
                                        const JointState& predicted, const JointVector& dq_sample_rad_s,
                                        double elapsed_s) {
  const double h = elapsed_s;
  const Eigen::Index n = arm.dof();
  const Eigen::Index p = arm.parameter_count();
  const PlanarArm::Posture at = arm.At(0.5 * (joints_.q_rad + predicted.q_rad));
  const JointVector dq_mid = 0.5 * (joints_.dq_rad_s + predicted.dq_rad_s);
  const JointVector ddq = (predicted.dq_rad_s - joints_.dq_rad_s) / h;
  const JointVector ddq_sample = (dq_sample_rad_s - joints_.dq_rad_s) / h;
  JointMatrix H_inverse = JointMatrix::Identity(n, n);
  arm.Inertia(at, theta_hat).llt().solveInPlace(H_inverse);

  // B = dv/db
  const RegressorMatrix Y = arm.Regressor(at, dq_mid, dq_mid, ddq);
  JointUnknownMatrix B(n, p + n);
  B.leftCols(p) = -h * H_inverse.lazyProduct(Y);
  B.rightCols(n) = -h * H_inverse;
  const JointUnknownMatrix BP = B.lazyProduct(P_bb_);
  JointMatrix V = BP.lazyProduct(B.transpose());
  V += Square(h * disturbance_.fast_deviation_Nm) * H_inverse.lazyProduct(H_inverse);
  if (second_order_) {
    // What theta makes of the part of the acceleration that the model did not foresee.
    const RegressorMatrix unforeseen =
        h * H_inverse.lazyProduct(arm.Regressor(at, dq_mid, dq_mid, ddq_sample) - Y);
    const RegressorMatrix unforeseen_P = unforeseen.lazyProduct(P_bb_.topLeftCorner(p, p));
    V += unforeseen_P.lazyProduct(unforeseen.transpose());
  }

  // P_xx = F P_xx F' + (F P_xb) (L B)' + (L B) (F P_xb)' + L V L',  P_xb = F P_xb + L B P_bb
  P_xx_.topRows(n) += h * P_xx_.bottomRows(n);
  P_xx_.leftCols(n) += h * P_xx_.rightCols(n);
  P_xb_.topRows(n) += h * P_xb_.bottomRows(n);
  const BoundedMatrix<kMaxJointStates, kMaxDof> cross = P_xb_.lazyProduct(B.transpose());
  P_xx_.leftCols(n) += (0.5 * h) * cross;
  P_xx_.rightCols(n) += cross;
  P_xx_.topRows(n) += (0.5 * h) * cross.transpose();
  P_xx_.bottomRows(n) += cross.transpose();
  // Of an acceleration that changes at random within the interval, q gets h^2/3 V instead of h^2/4 V.
  P_xx_.topLeftCorner(n, n) += (0.25 * h * h * (1.0 + Square(disturbance_.roughness) / 3.0)) * V;
  P_xx_.topRightCorner(n, n) += (0.5 * h) * V;
  P_xx_.bottomLeftCorner(n, n) += (0.5 * h) * V;
  P_xx_.bottomRightCorner(n, n) += V;
  P_xb_.topRows(n) += (0.5 * h) * BP;
  P_xb_.bottomRows(n) += BP;
  P_bb_.diagonal().head(p).array() += theta_drift_variance_;
  P_bb_.diagonal().tail(n).array() += Square(disturbance_.drift_Nm);
}

// Takes the sample into joints_ and the covariance; returns the change of b.
AugmentedFilter::UnknownVector AugmentedFilter::Correct(const JointState& predicted,
                                                        const JointState& sample) {
  const Eigen::Index n = sample.q_rad.size();
  StateVector innovation(2 * n);
  innovation << sample.q_rad - predicted.q_rad, sample.dq_rad_s - predicted.dq_rad_s;
  StateMatrix S = P_xx_;
  S.diagonal().head(n) += sensor_.position_deviation_rad.cwiseAbs2();
  S.diagonal().tail(n) += sensor_.velocity_deviation_rad_s.cwiseAbs2();
  const auto S_factor = S.llt();
  const StateVector weighted = S_factor.solve(innovation);
  const StateVector dx = P_xx_ * weighted;
  joints_ = {predicted.q_rad + dx.head(n), predicted.dq_rad_s + dx.tail(n)};
  const UnknownVector db = P_xb_.transpose() * weighted;

  // P = (I - K C) P, symmetric against rounding
  const CrossMatrix S_inverse_P_xb = S_factor.solve(P_xb_);
  const StateMatrix S_inverse_P_xx = S_factor.solve(P_xx_);
  const UnknownMatrix P_bb = P_bb_ - P_xb_.transpose().lazyProduct(S_inverse_P_xb);
  P_bb_ = 0.5 * (P_bb + P_bb.transpose());
  P_xb_ -= (P_xx_.lazyProduct(S_inverse_P_xb)).eval();
  const StateMatrix P_xx = P_xx_ - P_xx_.lazyProduct(S_inverse_P_xx);
  P_xx_ = 0.5 * (P_xx + P_xx.transpose());
  return db;
}

ParameterMatrix AugmentedFilter::P_theta() const {
  const Eigen::Index p = P_bb_.rows() - d_hat_Nm_.size();
  return P_bb_.topLeftCorner(p, p);
}

}  // namespace armada
