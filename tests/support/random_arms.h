#pragma once

#include <random>
#include <vector>

#include "firmware/core/planar_arm.h"
#include "firmware/core/pseudoinverse.h"
#include "hil/planar_plant.h"
#include "hil/random.h"

namespace armada {

/// Seeded random planar arms and states for properties that must hold for all of them.
class RandomArms {
 public:
  explicit RandomArms(uint64_t seed) : engine_(seed) {}

  double In(double low, double high) { return Uniform(engine_(), low, high); }

  /// An arm with links of human size, its base somewhere and turned somehow.
  PlanarArmConfig Config(int dof, double gravity_m_s2 = 0.0) {
    PlanarArmConfig config;
    config.dof = dof;
    for (int i = 0; i < dof; ++i) {
      LinkConfig& link = config.links[static_cast<size_t>(i)];
      link.m_kg = In(0.3, 3.0);
      link.l_m = In(0.3, 1.5);
      link.r_m = link.l_m * In(0.1, 1.0);
      link.I_kgm2 = In(0.05, 6.0);
    }
    config.base_x_m = In(-2.0, 2.0);
    config.base_y_m = In(-2.0, 2.0);
    config.base_orientation_rad = In(-3.0, 3.0);
    config.gravity_m_s2 = gravity_m_s2;
    return config;
  }

  /// Arms with 1 to kMaxDof joints, each with and without gravity, `count` of each kind.
  std::vector<PlanarArm> AllKinds(int count) {
    std::vector<PlanarArm> arms;
    for (int dof = 1; dof <= kMaxDof; ++dof) {
      for (const double gravity_m_s2 : {0.0, 9.81}) {
        for (int i = 0; i < count; ++i) arms.emplace_back(Config(dof, gravity_m_s2));
      }
    }
    return arms;
  }

  /// `size` numbers in +- `range`: joint positions, speeds, torques, parameters.
  template <class Vector = JointVector>
  Vector Numbers(Eigen::Index size, double range) {
    Vector numbers(size);
    for (double& number : numbers) number = In(-range, range);
    return numbers;
  }

 private:
  std::mt19937_64 engine_;
};

/// Joint values for the plant, which stores them without Eigen.
inline PlanarPlant::Joints ToPlant(const JointVector& values) {
  PlanarPlant::Joints joints{};
  std::copy(values.data(), values.data() + values.size(), joints.begin());
  return joints;
}

inline JointVector FromPlant(const PlanarPlant& plant, const PlanarPlant::Joints& joints) {
  return Eigen::Map<const Eigen::VectorXd>(joints.data(), plant.dof());
}

/// The Jacobian's smallest singular value: how far the arm is from a singularity.
inline double SigmaMin(const PlanarArm& arm, const JointVector& q) {
  return DampedPseudoinverse({}, arm.Jacobian(arm.At(q))).sigma_min;
}

}  // namespace armada
