#pragma once

#include <array>

#include "firmware/core/obstacle.h"
#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

/// One link of a planar arm: the columns of the paper's Table 1.
struct LinkConfig {
  double m_kg = 1.0;    ///< mass
  double l_m = 1.0;     ///< length
  double r_m = 0.5;     ///< distance of the centre of mass from the link's joint, in (0, l]
  double I_kgm2 = 0.1;  ///< moment of inertia about the centre of mass

  void Visit(ParameterVisitor& parameter) {
    parameter({"m_kg", "kg", 1e-6, 1e4, "mass of the link"}, m_kg);
    parameter({"l_m", "m", 1e-3, 100, "length of the link"}, l_m);
    parameter({"r_m", "m", 1e-6, 100, "distance from the link's joint to its centre of mass, at most l_m"},
              r_m);
    parameter({"I_kgm2", "kg m^2", 1e-9, 1e4, "moment of inertia about the centre of mass"}, I_kgm2);
  }
};

struct PlanarArmConfig {
  int dof = 0;
  std::array<LinkConfig, kMaxDof> links{};
  double base_x_m = 0.0;  ///< base in the fleet's world frame
  double base_y_m = 0.0;
  double base_orientation_rad = 0.0;  ///< angle of the first link at q_1 = 0
  double gravity_m_s2 = 0.0;  ///< along -y of the world; 0 for an arm that moves in a horizontal plane
  JointVector q_min_rad;  ///< limits of the joints, n components; empty: none, the joints turn without end
  JointVector q_max_rad;
  int obstacle_count = 0;
  std::array<ObstacleConfig, kMaxObstacles> obstacles{};

  void Visit(ParameterVisitor& parameter) {
    parameter({"base_x_m", "m", -1e3, 1e3, "x of the arm's base in the world frame"}, base_x_m);
    parameter({"base_y_m", "m", -1e3, 1e3, "y of the arm's base in the world frame"}, base_y_m);
    parameter(
        {"base_orientation_rad", "rad", -7, 7, "angle of the first link at q_1 = 0, from the world's x axis"},
        base_orientation_rad);
    parameter(
        {"gravity_m_s2", "m/s^2", 0, 30, "gravity along -y of the world; 0 for an arm in a horizontal plane"},
        gravity_m_s2);
    parameter(
        {"q_min_rad", "rad", -1e3, 1e3,
         "least angle of the joints, which spare joints keep: one value, or one a joint; left out: none"},
        q_min_rad);
    parameter({"q_max_rad", "rad", -1e3, 1e3, "largest angle of the joints, in the same way"}, q_max_rad);
  }
};

/// Planar arm with 1 to 7 revolute joints, task dimension m = 2: kinematics and the linear-in-parameters
/// dynamics of (1.1), (P1)-(P3).
///
/// With the absolute link angles th = base + T q (T lower triangular of ones) and W = T dq,
///   H(q)      = T' [D_ab cos(th_a - th_b)] T,
///   C(q,dq) y = T' [sum_b D_ab sin(th_a - th_b) W_b (T y)_b],     (Christoffel: dH/dt - 2C is skew
///   symmetric) g(q)      = T' [g0 G_a cos th_a],
/// where D_ab = sum_k m_k c_ka c_kb + delta_ab I_a, G_a = sum_k m_k c_ka, c_ka = l_a for a < k, r_k for a =
/// k. theta = (D_11, D_12, .., D_1n, D_22, .., D_nn [, G_1, .., G_n when gravity_m_s2 != 0]), kg m^2 and kg
/// m.
class PlanarArm {
 public:
  static constexpr int kTaskDim = 2;

  /// Cosine and sine of every link's absolute angle at a joint position: computed once, used by all the rest.
  struct Posture {
    JointVector cosine;
    JointVector sine;
  };

  explicit PlanarArm(const PlanarArmConfig& config);

  int dof() const { return config_.dof; }
  int parameter_count() const { return parameter_count_; }
  const PlanarArmConfig& config() const { return config_; }
  /// Radii, from the base, of the ring that the end effector can reach, m.
  double reach_min_m() const { return reach_min_m_; }
  double reach_max_m() const { return reach_max_m_; }
  TaskVector Base() const;

  Posture At(const JointVector& q) const;
  /// psi(q): end effector in the world frame, m.
  TaskVector Position(const Posture& at) const;
  /// J(q) = d psi / d q, 2 x n.
  JacobianMatrix Jacobian(const Posture& at) const;
  /// dJ/dt along dq, 2 x n.
  JacobianMatrix JacobianRate(const Posture& at, const JointVector& dq) const;

  /// True parameters of the configured links.
  ParameterVector Theta() const;
  /// Y(q, dq, y, x) of (P3): Y theta = H(q) x + C(q, dq) y + g(q). n x parameter_count.
  RegressorMatrix Regressor(const Posture& at, const JointVector& dq, const JointVector& y,
                            const JointVector& x) const;
  /// H(q) for a parameter vector.
  JointMatrix Inertia(const Posture& at, const ParameterVector& theta) const;
  /// C(q, dq) as a matrix, for a parameter vector.
  JointMatrix Coriolis(const Posture& at, const JointVector& dq, const ParameterVector& theta) const;
  /// C(q, dq) dq + g(q) for a parameter vector: what torque must supply beside acceleration.
  JointVector Bias(const Posture& at, const JointVector& dq, const ParameterVector& theta) const;

  /// Index in theta of D_ab, a <= b.
  int InertiaIndex(int a, int b) const { return a * dof() - a * (a - 1) / 2 + (b - a); }
  int InertiaParameterCount() const { return dof() * (dof() + 1) / 2; }

 private:
  PlanarArmConfig config_;
  int parameter_count_ = 0;
  double reach_min_m_ = 0.0;
  double reach_max_m_ = 0.0;
};

}  // namespace armada
