#pragma once

#include <array>

#include "firmware/core/planar_arm.h"

namespace armada {

/// The emulated arm's mechanics: joint positions and speeds under joint torques. Derived apart from the
/// controller's model (articulated-body recursion on link accelerations, no inertia matrix), so that a
/// mistake there cannot hide here; only the parameters are shared.
class PlanarPlant {
 public:
  using Joints = std::array<double, kMaxDof>;

  explicit PlanarPlant(const PlanarArmConfig& config)
      : config_(config), posture_(PostureAt(posture_q_rad_)) {}

  int dof() const { return config_.dof; }
  const PlanarArmConfig& config() const { return config_; }

  Joints q_rad{};
  Joints dq_rad_s{};

  /// One step of the classical Runge-Kutta method under constant torque.
  void Step(const Joints& tau_Nm, double dt_s);

  /// Joint accelerations at (q, dq) under torque.
  Joints Acceleration(const Joints& q, const Joints& dq, const Joints& tau_Nm) const;

  /// End effector in the world frame, position and velocity.
  struct Tip {
    std::array<double, 2> x_m;
    std::array<double, 2> v_m_s;
  };
  Tip EndEffector() const;

  /// Kinetic plus potential energy, J.
  double Energy() const;

 private:
  /// Cosine and sine of the links' absolute angles.
  struct Posture {
    Joints cosine, sine;
  };
  Posture PostureAt(const Joints& q) const;
  /// At q_rad: what the last step left, unless q_rad was set since.
  Posture Here() const { return q_rad == posture_q_rad_ ? posture_ : PostureAt(q_rad); }
  /// `from` after dt_s at the joint speeds dq.
  Posture Turned(const Posture& from, const Joints& dq, double dt_s) const;
  Joints Acceleration(const Posture& at, const Joints& dq, const Joints& tau_Nm) const;

  PlanarArmConfig config_;
  Joints posture_q_rad_{};
  Posture posture_;  ///< at posture_q_rad_
};

}  // namespace armada
