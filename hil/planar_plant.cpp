#include "hil/planar_plant.h"

#include <cmath>

namespace armada {
namespace {

// What a link feels at its end of the links beyond, the joint there free to turn: a mass that differs by
// direction, symmetric, a force, world axes, and the moment of the joint's drive.
struct Load {
  double xx, xy, yy;
  double force_x, force_y;
  double moment;
};

/// A turn by `angle`: sine, and cosine less one, so that a small turn costs no digit.
struct Turn {
  double sine, cosine_less_one;
};

Turn TurnBy(double angle) {
  // Below it the series' next terms are less than half a unit of the result's last digit.
  constexpr double kSmall_rad = 0.06;
  if (!(std::abs(angle) < kSmall_rad)) {
    const double half_sine = std::sin(0.5 * angle);
    return {std::sin(angle), -2.0 * half_sine * half_sine};
  }
  const double x = angle * angle;
  return {angle - angle * x * (1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0))),
          -x * (0.5 - x * (1.0 / 24.0 - x * (1.0 / 720.0 - x * (1.0 / 40320.0))))};
}

}  // namespace

PlanarPlant::Posture PlanarPlant::PostureAt(const Joints& q) const {
  Posture at{};
  double angle = config_.base_orientation_rad;
  for (size_t i = 0; i < static_cast<size_t>(config_.dof); ++i) {
    angle += q[i];
    at.cosine[i] = std::cos(angle);
    at.sine[i] = std::sin(angle);
  }
  return at;
}

// The stages of a step are turned a little from its start: no need for new cosines and sines.
PlanarPlant::Posture PlanarPlant::Turned(const Posture& from, const Joints& dq, double dt_s) const {
  Posture at{};
  double omega = 0.0;
  for (size_t i = 0; i < static_cast<size_t>(config_.dof); ++i) {
    omega += dq[i];
    const Turn turn = TurnBy(dt_s * omega);
    at.cosine[i] = from.cosine[i] + (from.cosine[i] * turn.cosine_less_one - from.sine[i] * turn.sine);
    at.sine[i] = from.sine[i] + (from.sine[i] * turn.cosine_less_one + from.cosine[i] * turn.sine);
  }
  return at;
}

PlanarPlant::Joints PlanarPlant::Acceleration(const Joints& q, const Joints& dq, const Joints& tau_Nm) const {
  return Acceleration(PostureAt(q), dq, tau_Nm);
}

PlanarPlant::Joints PlanarPlant::Acceleration(const Posture& at, const Joints& dq,
                                              const Joints& tau_Nm) const {
  const size_t n = static_cast<size_t>(config_.dof);
  const auto& [cosine, sine] = at;
  std::array<double, kMaxDof> omega_squared;
  double omega = 0.0;
  for (size_t i = 0; i < n; ++i) {
    omega += dq[i];
    omega_squared[i] = omega * omega;
  }

  // From the tip to the base: each link with everything it carries, as felt at its joint. With the angular
  // acceleration a_w and its joint's acceleration (a_x, a_y) a link needs the moment D a_w + U_x a_x + U_y
  // a_y - u beside its drive's.
  std::array<double, kMaxDof> U_x, U_y, D_inverse, u, centripetal_x, centripetal_y;
  Load load{};
  for (size_t i = n; i-- > 0;) {
    const LinkConfig& link = config_.links[i];
    const double m = link.m_kg;
    const double rx = link.r_m * cosine[i];
    const double ry = link.r_m * sine[i];
    const double lx = link.l_m * cosine[i];
    const double ly = link.l_m * sine[i];
    const double weight = m * config_.gravity_m_s2;

    const double h_x = lx * load.xy - ly * load.xx;  // the load's force when the link alone turns
    const double h_y = lx * load.yy - ly * load.xy;
    D_inverse[i] = 1.0 / (link.I_kgm2 + m * (link.r_m * link.r_m) + (lx * h_y - ly * h_x));
    U_x[i] = h_x - m * ry;
    U_y[i] = h_y + m * rx;
    u[i] = tau_Nm[i] - (weight * rx + load.moment + (lx * load.force_y - ly * load.force_x));
    if (i == 0) break;

    // Free the joint: what the link before feels of it, whose end is drawn towards its own joint.
    const double U_x_per_D = U_x[i] * D_inverse[i];
    const double U_y_per_D = U_y[i] * D_inverse[i];
    const double force_x = load.force_x - m * omega_squared[i] * rx;
    const double force_y = load.force_y - m * omega_squared[i] * ry + weight;
    const double xx = load.xx + m - U_x_per_D * U_x[i];
    const double xy = load.xy - U_x_per_D * U_y[i];
    const double yy = load.yy + m - U_y_per_D * U_y[i];
    const double towards = -omega_squared[i - 1] * config_.links[i - 1].l_m;
    const double c_x = centripetal_x[i] = towards * cosine[i - 1];
    const double c_y = centripetal_y[i] = towards * sine[i - 1];
    load = {xx,
            xy,
            yy,
            force_x + (xx * c_x + xy * c_y) + U_x_per_D * u[i],
            force_y + (xy * c_x + yy * c_y) + U_y_per_D * u[i],
            tau_Nm[i]};
  }

  // From the base to the tip: accelerations. The base stands still.
  Joints ddq{};
  double a_w = 0.0;
  double a_x = 0.0;
  double a_y = 0.0;
  for (size_t i = 0; i < n; ++i) {
    if (i > 0) {
      const double across = a_w * config_.links[i - 1].l_m;
      a_x += centripetal_x[i] - across * sine[i - 1];
      a_y += centripetal_y[i] + across * cosine[i - 1];
    }
    const double a_next = (u[i] - (U_x[i] * a_x + U_y[i] * a_y)) * D_inverse[i];
    ddq[i] = a_next - a_w;
    a_w = a_next;
  }
  return ddq;
}

void PlanarPlant::Step(const Joints& tau_Nm, double dt_s) {
  const size_t n = static_cast<size_t>(config_.dof);
  const auto ahead = [n](const Joints& from, const Joints& rate, double dt) {
    Joints result{};
    for (size_t i = 0; i < n; ++i) result[i] = from[i] + dt * rate[i];
    return result;
  };
  const double half = 0.5 * dt_s;
  const Posture here = Here();
  const Joints k1_dq = dq_rad_s;
  const Joints k1_ddq = Acceleration(here, k1_dq, tau_Nm);
  const Joints k2_dq = ahead(dq_rad_s, k1_ddq, half);
  const Joints k2_ddq = Acceleration(Turned(here, k1_dq, half), k2_dq, tau_Nm);
  const Joints k3_dq = ahead(dq_rad_s, k2_ddq, half);
  const Joints k3_ddq = Acceleration(Turned(here, k2_dq, half), k3_dq, tau_Nm);
  const Joints k4_dq = ahead(dq_rad_s, k3_ddq, dt_s);
  const Joints k4_ddq = Acceleration(Turned(here, k3_dq, dt_s), k4_dq, tau_Nm);
  for (size_t i = 0; i < n; ++i) {
    q_rad[i] += dt_s / 6.0 * (k1_dq[i] + 2.0 * k2_dq[i] + 2.0 * k3_dq[i] + k4_dq[i]);
    dq_rad_s[i] += dt_s / 6.0 * (k1_ddq[i] + 2.0 * k2_ddq[i] + 2.0 * k3_ddq[i] + k4_ddq[i]);
  }
  posture_ = PostureAt(q_rad);
  posture_q_rad_ = q_rad;
}

PlanarPlant::Tip PlanarPlant::EndEffector() const {
  Tip tip{{config_.base_x_m, config_.base_y_m}, {0.0, 0.0}};
  const Posture here = Here();
  double omega = 0.0;
  for (size_t i = 0; i < static_cast<size_t>(config_.dof); ++i) {
    omega += dq_rad_s[i];
    const double x = config_.links[i].l_m * here.cosine[i];
    const double y = config_.links[i].l_m * here.sine[i];
    tip.x_m[0] += x;
    tip.x_m[1] += y;
    tip.v_m_s[0] -= omega * y;
    tip.v_m_s[1] += omega * x;
  }
  return tip;
}

double PlanarPlant::Energy() const {
  double energy = 0.0;
  double angle = config_.base_orientation_rad;
  double omega = 0.0;
  double y = config_.base_y_m;
  double vx = 0.0;
  double vy = 0.0;
  for (size_t i = 0; i < static_cast<size_t>(config_.dof); ++i) {
    const LinkConfig& link = config_.links[i];
    angle += q_rad[i];
    omega += dq_rad_s[i];
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const double com_vx = vx - omega * link.r_m * s;
    const double com_vy = vy + omega * link.r_m * c;
    energy += 0.5 * link.m_kg * (com_vx * com_vx + com_vy * com_vy) + 0.5 * link.I_kgm2 * omega * omega;
    energy += link.m_kg * config_.gravity_m_s2 * (y + link.r_m * s);
    vx -= omega * link.l_m * s;
    vy += omega * link.l_m * c;
    y += link.l_m * s;
  }
  return energy;
}

}  // namespace armada
