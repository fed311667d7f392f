#include "host/floor/exact_filter.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

// An element of (q, dq, d) of an arm, i from 0 to 3 n - 1.
double& Element(MovingArm* arm, Eigen::Index i) {
  const Eigen::Index n = arm->plant.dof();
  const auto joint = static_cast<size_t>(i % n);
  if (i < n) return arm->plant.q_rad[joint];
  if (i < 2 * n) return arm->plant.dq_rad_s[joint];
  return arm->disturbance.deviation_Nm[joint];
}

}  // namespace

ExactFilter::ExactFilter(const ExactFilterConfig& config, const MovingArm& start)
    : config_(config), dof_(start.plant.dof()), belief_(start) {
  measurement_variance_.resize(2 * dof_);
  for (Eigen::Index i = 0; i < dof_; ++i) {
    measurement_variance_[i] = std::pow(config_.q_deviation_rad[static_cast<size_t>(i)], 2);
    measurement_variance_[dof_ + i] = std::pow(config_.dq_deviation_rad_s[static_cast<size_t>(i)], 2);
  }
  P_ = Matrix::Zero(3 * dof_, 3 * dof_);
  P_.diagonal().head(2 * dof_) = measurement_variance_;
}

// One number after the other: their noises are independent, and nothing has to be inverted.
void ExactFilter::Correct(const JointReadings& readings) {
  Vector correction = Vector::Zero(3 * dof_);
  for (Eigen::Index i = 0; i < 2 * dof_; ++i) {
    const auto joint = static_cast<size_t>(i % dof_);
    const double measured = i < dof_ ? readings.q_rad[joint] : readings.dq_rad_s[joint];
    const double innovation = measured - (Element(&belief_, i) + correction[i]);
    const double variance = P_(i, i) + measurement_variance_[i];
    const Vector gain = P_.col(i) / variance;
    correction += gain * innovation;
    P_ -= variance * gain * gain.transpose();
  }
  for (Eigen::Index i = 0; i < 3 * dof_; ++i) Element(&belief_, i) += correction[i];
}

void ExactFilter::AdvanceTo(double end_s, const DelayedTorques& torques, double step_s) {
  while (belief_.t_s < end_s) {
    RenewDeviation();
    const double until_s = std::min(end_s, belief_.disturbance.NextChange(belief_.t_s));
    const Matrix F = Sensitivity(until_s, torques);
    belief_.AdvanceTo(until_s, torques, step_s);
    P_ = F * P_ * F.transpose();
    P_ = 0.5 * (P_ + P_.transpose().eval());
    // What the sensitivities miss of the disturbance's effect.
    const double missed_Nm = config_.missed_share * config_.disturbance_Nm;
    P_.diagonal().head(2 * dof_) +=
        std::pow(missed_Nm, 2) * F.topRightCorner(2 * dof_, dof_).rowwise().squaredNorm();
  }
}

void ExactFilter::RenewDeviation() {
  if (!belief_.disturbance.Renew(belief_.t_s, belief_.plant)) return;
  P_.rightCols(dof_).setZero();
  P_.bottomRows(dof_).setZero();
  P_.diagonal().tail(dof_).setConstant(std::pow(config_.disturbance_Nm, 2));
}

ExactFilter::Matrix ExactFilter::Sensitivity(double end_s, const DelayedTorques& torques) const {
  constexpr double kStep = 1e-4;  // rad, rad/s, N m
  const auto moved = [&](Eigen::Index element, double by) {
    MovingArm arm = belief_;
    if (by != 0.0) Element(&arm, element) += by;
    arm.AdvanceTo(end_s, torques, kSearchStep_s);
    return arm;
  };
  MovingArm reference = moved(0, 0.0);
  Matrix F = Matrix::Identity(3 * dof_, 3 * dof_);
  for (Eigen::Index column = 0; column < 3 * dof_; ++column) {
    MovingArm arm = moved(column, kStep);
    for (Eigen::Index row = 0; row < 2 * dof_; ++row) {
      F(row, column) = (Element(&arm, row) - Element(&reference, row)) / kStep;
    }
  }
  return F;
}

}  // namespace armada
