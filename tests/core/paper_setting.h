#pragma once

#include <cmath>
#include <numbers>

#include "firmware/core/arm_controller.h"
#include "firmware/core/graph.h"

namespace armada {

/// Section 4 of the paper: arms, leader, graph and gains.

inline constexpr double kPeriod_s = 0.01;

/// Arm `id` (1 .. 7) of Table 1, base at the origin.
inline PlanarArmConfig PaperArm(int id) {
  static constexpr std::array<int, 7> kDof = {2, 2, 2, 2, 2, 3, 3};
  static constexpr std::array<std::array<LinkConfig, 3>, 7> kLinks = {{
      {{{0.8, 1.4, 0.8, 6}, {0.6, 0.9, 0.45, 3}}},
      {{{1, 1.2, 0.7, 2}, {0.8, 1.1, 0.5, 3}}},
      {{{0.5, 1.1, 0.4, 5}, {0.8, 1.3, 0.6, 3}}},
      {{{1.5, 1.1, 0.6, 5}, {0.8, 1.2, 0.6, 4}}},
      {{{2.3, 1.0, 0.4, 5}, {0.8, 1.2, 0.7, 3}}},
      {{{0.8, 0.8, 0.4, 4}, {1.2, 1.1, 0.5, 6}, {1.4, 1.4, 0.7, 5}}},
      {{{1.8, 1, 0.6, 5}, {1.2, 1.1, 0.6, 6}, {1.4, 1.2, 0.6, 5}}},
  }};
  PlanarArmConfig config;
  const auto index = static_cast<size_t>(id - 1);
  config.dof = kDof[index];
  for (size_t i = 0; i < static_cast<size_t>(config.dof); ++i) config.links[i] = kLinks[index][i];
  return config;
}

/// (0.5) with its derivatives.
inline Zeta PaperLeader(double t_s) {
  constexpr double w = std::numbers::pi;
  const double s = std::sin(w * t_s);
  const double c = std::cos(w * t_s);
  return {TaskVector{{1.2 + 0.5 * s, 1.3 + 0.3 * c}}, TaskVector{{0.5 * w * c, -0.3 * w * s}},
          TaskVector{{-0.5 * w * w * s, -0.3 * w * w * c}}};
}

/// Its jerk.
inline TaskVector PaperLeaderJerk(double t_s) {
  constexpr double w = std::numbers::pi;
  return TaskVector{{-0.5 * w * w * w * std::cos(w * t_s), 0.3 * w * w * w * std::sin(w * t_s)}};
}

/// Suprema of (A2) for that leader.
inline constexpr double kLeaderSpeed_m_s = 0.5 * std::numbers::pi;
inline constexpr double kLeaderAcceleration_m_s2 = kLeaderSpeed_m_s * std::numbers::pi;
inline constexpr double kLeaderJerk_m_s3 = kLeaderAcceleration_m_s2 * std::numbers::pi;

/// Fig. 2: nodes 1, 3, 5, 7 see the leader; 2 and 4 listen to 1 and 3, 6 to 5. Node i of the paper is i - 1
/// here.
inline Digraph PaperGraph() {
  Digraph graph(7);
  for (const int pinned : {0, 2, 4, 6}) graph.SetPin(pinned, 1.0);
  for (const int listener : {1, 3}) {
    graph.SetWeight(listener, 0, 1.0);
    graph.SetWeight(listener, 2, 1.0);
  }
  graph.SetWeight(5, 4, 1.0);
  return graph;
}

/// Of the robust law's reference, with the paper's alpha.
inline constexpr Approach kApproach{.alpha_1_s = 50.0, .braking_m_s2 = 6.0, .speed_m_s = 2.0};

/// The paper's gains, robust law, for an arm of `arm.dof` joints.
inline ArmControllerConfig PaperController(const PlanarArmConfig& arm) {
  ArmControllerConfig config;
  config.arm = arm;
  config.control.gains.K_s_Nms_rad[0] = arm.dof > 2 ? 150.0 : 100.0;
  config.control.Expand(arm.dof, PlanarArm::kTaskDim);
  config.torque_limit_Nm = JointVector::Constant(arm.dof, arm.dof > 2 ? 300.0 : 150.0);
  return config;
}

}  // namespace armada
