#pragma once

#include "firmware/core/types.h"

namespace armada {

/// zeta = col(x, v, a) of (0.9): a state of the leader, or an estimate of it, in the world frame; m
/// components each.
struct Zeta {
  TaskVector x_m;
  TaskVector v_m_s;
  TaskVector a_m_s2;

  static Zeta Zero(Eigen::Index task_dim) {
    return {TaskVector::Zero(task_dim), TaskVector::Zero(task_dim), TaskVector::Zero(task_dim)};
  }
  bool AllFinite() const { return x_m.allFinite() && v_m_s.allFinite() && a_m_s2.allFinite(); }
};

/// The state `ahead_s` later under constant acceleration.
inline Zeta Taylor(const Zeta& zeta, double ahead_s) {
  return {zeta.x_m + ahead_s * zeta.v_m_s + (0.5 * ahead_s * ahead_s) * zeta.a_m_s2,
          zeta.v_m_s + ahead_s * zeta.a_m_s2, zeta.a_m_s2};
}

/// The state `ahead_s` later under constant jerk.
inline Zeta Taylor(const Zeta& zeta, const TaskVector& jerk_m_s3, double ahead_s) {
  const double t2_2 = 0.5 * ahead_s * ahead_s;
  Zeta later = Taylor(zeta, ahead_s);
  later.x_m += (t2_2 * ahead_s / 3.0) * jerk_m_s3;
  later.v_m_s += t2_2 * jerk_m_s3;
  later.a_m_s2 += ahead_s * jerk_m_s3;
  return later;
}

}  // namespace armada
