#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

struct ImplicitControlConfig {
  bool on = true;
  int sweeps = 60;
  double tolerance_rad_s = 1e-12;

  void Visit(ParameterVisitor& parameter) {
    parameter({"on", "", 0, 1, "(1.2) by implicit Euler; false: as printed, which chatters"}, on);
    parameter(
        {"sweeps", "", 1, 1000, "bound on sweeps of the coordinate descent that solves the implicit sgn"},
        sweeps);
    parameter({"tolerance_rad_s", "rad/s", 0, 1e-3, "the descent ends when no component of s+ moves by more"},
              tolerance_rad_s);
  }
};

/// s+ of the implicit form of (1.2): argmin 1/2 s' A s - b' s + sum_i w_i |s_i|, A symmetric positive
/// definite, by exact coordinate descent. Where |b_i - ..| <= w_i the component is exactly zero: no chatter.
JointVector MinimizeWithL1(const ImplicitControlConfig& config, const JointMatrix& A, const JointVector& b,
                           const JointVector& w);

}  // namespace armada
