#pragma once

namespace armada {

/// State feedback a = -k1 e - k2 de/dt, held over one sampling period h, that minimises the integral of e^2
/// of a disturbed double integrator d^2e/dt^2 = a + noise, between the samples too, whatever a costs.
///
/// Without a cost on a the gains depend on h alone, and have a closed form. The response of e to one held a
/// is a quadratic spline, so its inner products are the quintic B-spline at the integers, 1, 26, 66, 26, 1
/// (/120): spectral factorisation leaves the stable roots z^2 + alpha z + beta of z^4 + 26 z^3 + 66 z^2 + 26
/// z + 1 as the closed loop.
struct SampledLqr {
  double k1_h2 = 0.0;  ///< k1 h^2
  double k2_h = 0.0;   ///< k2 h

  static SampledLqr Compute();
};

}  // namespace armada
