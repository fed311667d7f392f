#pragma once

#include "firmware/core/adaptation.h"
#include "firmware/core/forward_dynamics.h"
#include "firmware/core/parameter.h"

namespace armada {

/// What the joints' samples are worth. In the configuration one number stands for all joints.
struct SensorConfig {
  JointVector position_deviation_rad = JointVector::Constant(1, 1e-5);
  JointVector velocity_deviation_rad_s = JointVector::Constant(1, 1e-3);
  double start_speed_rad_s = 10.0;
  double frozen_deviations = 4.0;
  double frozen_travel_rad = 0.01;
  double frozen_pushed_s = 0.1;
  double consistent_travel_rad = 0.05;
  double consistent_s = 0.1;
  double consistent_deviations = 6.0;

  void Visit(ParameterVisitor& parameter) {
    parameter(
        {"position_deviation_rad", "rad", 1e-9, 1,
         "standard deviation of a sample of q, beside the resolution of the drive's frames; one value or "
         "one a joint"},
        position_deviation_rad);
    parameter({"velocity_deviation_rad_s", "rad/s", 1e-7, 1e6,
               "the same of a sample of dq; very large: the drive's velocity is not used"},
              velocity_deviation_rad_s);
    parameter({"start_speed_rad_s", "rad/s", 1e-3, 1e3,
               "standard deviation of dq at the start where its sample is worth less"},
              start_speed_rad_s);
    parameter({"frozen_deviations", "", 1, 100,
               "speed, in its standard deviations, above which a joint counts as moving"},
              frozen_deviations);
    parameter({"frozen_travel_rad", "rad", 1e-6, 10,
               "travel by a moving joint's speed, beside the resolution of its position, over which that "
               "position may repeat to the bit; further, and the feedback is frozen: FAULT"},
              frozen_travel_rad);
    parameter(
        {"frozen_pushed_s", "s", 1e-3, 100,
         "time at its torque limit over which a joint's position may repeat to the bit; longer, and it is "
         "blocked or its feedback is frozen: FAULT"},
        frozen_pushed_s);
    parameter(
        {"consistent_travel_rad", "rad", 1e-6, 10,
         "way that a joint's position may go beyond the integral of its speed, beside the noise of both; "
         "further, and the feedback makes no sense: FAULT"},
        consistent_travel_rad);
    parameter({"consistent_s", "s", 1e-3, 10, "time over which such a way is forgotten"}, consistent_s);
    parameter({"consistent_deviations", "", 1, 100,
               "and what noise of the speed may add to it, in standard deviations"},
              consistent_deviations);
  }

  /// Single values spread over `dof` joints.
  void Expand(int dof) {
    for (JointVector* deviation : {&position_deviation_rad, &velocity_deviation_rad_s}) {
      if (deviation->size() == 1) *deviation = JointVector::Constant(dof, (*deviation)[0]);
    }
  }
};

/// d(t) of (1.1) as a bounded slow part, a random walk, and a fast one, independent from tick to tick.
struct DisturbanceModelConfig {
  double fast_deviation_Nm = 23.094;  ///< 40 / sqrt(3): of a disturbance uniform in +-40 N m
  double roughness = 0.3;
  double drift_Nm = 1.0;
  double bound_Nm = 40.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"fast_deviation_Nm", "N m", 1e-6, 1e5,
               "standard deviation of what disturbs a joint's torque anew each tick"},
              fast_deviation_Nm);
    parameter({"roughness", "", 0.01, 1,
               "share of the unknown torque that changes within a tick; the rest is held"},
              roughness);
    parameter({"drift_Nm", "N m", 0, 1e5,
               "standard deviation by which the slow part d_hat changes in a tick; 0: no such part"},
              drift_Nm);
    parameter({"bound_Nm", "N m", 0, 1e5, "largest disturbance that d_hat may claim, per joint"}, bound_Nm);
  }
};

/// Extended Kalman filter on [q; dq; theta; d] from the joints' samples and the torque applied between them.
/// It predicts with the torque really sent, so that saturation cannot wind it up; its regressor is at the
/// model's acceleration, not the measured one: no errors-in-variables bias; and what theta's error makes of
/// the difference between the two is counted as noise, so that a wrong start does not make it sure of itself.
class AugmentedFilter {
 public:
  /// Torque over the interval between two samples: `before_Nm` for the first `before_s`, `after_Nm` then.
  struct Applied {
    JointVector before_Nm;
    double before_s = 0.0;
    JointVector after_Nm;
  };

  /// `P_theta`: covariance of theta_hat's start, p x p; zero where theta_hat is not to be changed.
  AugmentedFilter(const SensorConfig& sensor, const DisturbanceModelConfig& disturbance,
                  const AdaptationConfig& adaptation, const ParameterMatrix& P_theta, const PlanarArm& arm);

  /// The first sample.
  void Start(const JointState& sample);
  /// A sample `elapsed_s` after the one before. theta_hat is corrected, not projected.
  void Update(const PlanarArm& arm, const Applied& applied, const JointState& sample, double elapsed_s,
              ParameterVector& theta_hat);

  /// At the newest sample.
  const JointState& joints() const { return joints_; }
  const JointVector& d_hat_Nm() const { return d_hat_Nm_; }
  ParameterMatrix P_theta() const;

 private:
  static constexpr int kMaxJointStates = 2 * kMaxDof;
  static constexpr int kMaxUnknowns = kMaxParameters + kMaxDof;
  using StateVector = BoundedVector<kMaxJointStates>;
  using StateMatrix = BoundedMatrix<kMaxJointStates, kMaxJointStates>;
  using UnknownVector = BoundedVector<kMaxUnknowns>;
  using CrossMatrix = BoundedMatrix<kMaxJointStates, kMaxUnknowns>;
  using UnknownMatrix = BoundedMatrix<kMaxUnknowns, kMaxUnknowns>;
  using JointUnknownMatrix = BoundedMatrix<kMaxDof, kMaxUnknowns>;

  JointState Predict(const PlanarArm& arm, const ParameterVector& theta_hat, const Applied& applied,
                     double elapsed_s) const;
  void PredictCovariance(const PlanarArm& arm, const ParameterVector& theta_hat, const JointState& predicted,
                         const JointVector& dq_sample_rad_s, double elapsed_s);
  UnknownVector Correct(const JointState& predicted, const JointState& sample);

  SensorConfig sensor_;
  DisturbanceModelConfig disturbance_;
  double theta_drift_variance_;
  bool second_order_;
  JointState joints_;
  JointVector d_hat_Nm_;
  // Covariance of [x; b], x = [q; dq], b = [theta; d].
  StateMatrix P_xx_;
  CrossMatrix P_xb_;
  UnknownMatrix P_bb_;
};

}  // namespace armada
