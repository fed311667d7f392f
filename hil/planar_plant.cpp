#include "hil/planar_plant.h"

#include <cmath>

namespace armada {
namespace {

// Angular acceleration of a link and linear acceleration of its joint, world axes; or the moment about that
// joint and the force.
struct Planar {
  double angular, x, y;
};

// Symmetric 3 x 3 inertia that maps such an acceleration to such a force.
struct Inertia {
  double aa, ax, ay, xx, xy, yy;
};

Planar operator*(const Inertia& inertia, const Planar& a) {
  return {inertia.aa * a.angular + inertia.ax * a.x + inertia.ay * a.y,
          inertia.ax * a.angular + inertia.xx * a.x + inertia.xy * a.y,
          inertia.ay * a.angular + inertia.xy * a.x + inertia.yy * a.y};
}

}  // namespace

PlanarPlant::Joints PlanarPlant::Acceleration(const Joints& q, const Joints& dq, const Joints& tau_Nm) const {
  const size_t n = static_cast<size_t>(config_.dof);
  std::array<double, kMaxDof> cosine, sine, omega;
  std::array<Planar, kMaxDof> U, centripetal;
  std::array<double, kMaxDof> D, u;

  double angle = config_.base_orientation_rad;
  double speed = 0.0;
  for (size_t i = 0; i < n; ++i) {
    angle += q[i];
    speed += dq[i];
    cosine[i] = std::cos(angle);
    sine[i] = std::sin(angle);
    omega[i] = speed;
  }

  // From the tip to the base: each link with everything it carries, as felt at its joint.
  Inertia carried{};  // articulated inertia and force of the links beyond, at the link's far end
  Planar carried_force{};
  for (size_t i = n; i-- > 0;) {
    const LinkConfig& link = config_.links[i];
    const double rx = link.r_m * cosine[i];
    const double ry = link.r_m * sine[i];
    const double lx = link.l_m * cosine[i];
    const double ly = link.l_m * sine[i];
    const double m = link.m_kg;
    const double omega_squared = omega[i] * omega[i];

    // The link alone, plus what it carries moved from its far end to its joint.
    const Inertia& c = carried;
    Inertia inertia{link.I_kgm2 + m * (rx * rx + ry * ry), -m * ry, m * rx, m, 0.0, m};
    const double hx = c.ax - ly * c.xx + lx * c.xy;
    const double hy = c.ay - ly * c.xy + lx * c.yy;
    inertia.aa += c.aa - ly * (c.ax + hx) + lx * (c.ay + hy);
    inertia.ax += hx;
    inertia.ay += hy;
    inertia.xx += c.xx;
    inertia.xy += c.xy;
    inertia.yy += c.yy;
    Planar force{m * config_.gravity_m_s2 * rx, -m * omega_squared * rx,
                 -m * omega_squared * ry + m * config_.gravity_m_s2};
    force.angular += carried_force.angular - ly * carried_force.x + lx * carried_force.y;
    force.x += carried_force.x;
    force.y += carried_force.y;

    D[i] = inertia.aa;
    U[i] = {inertia.aa, inertia.ax, inertia.ay};
    u[i] = tau_Nm[i] - force.angular;

    if (i == 0) break;
    // Free the joint: what the link before feels of it.
    carried = {0.0,
               0.0,
               0.0,
               inertia.xx - U[i].x * U[i].x / D[i],
               inertia.xy - U[i].x * U[i].y / D[i],
               inertia.yy - U[i].y * U[i].y / D[i]};
    const LinkConfig& before = config_.links[i - 1];
    const double before_squared = omega[i - 1] * omega[i - 1];
    centripetal[i] = {0.0, -before_squared * before.l_m * cosine[i - 1],
                      -before_squared * before.l_m * sine[i - 1]};
    const Planar reaction = carried * centripetal[i];
    const double through = u[i] / D[i];
    carried_force = {force.angular + reaction.angular + U[i].angular * through,
                     force.x + reaction.x + U[i].x * through, force.y + reaction.y + U[i].y * through};
  }

  // From the base to the tip: accelerations. The base stands still.
  Joints ddq{};
  Planar a{0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; ++i) {
    if (i > 0) {
      const LinkConfig& before = config_.links[i - 1];
      a.x += -a.angular * before.l_m * sine[i - 1] + centripetal[i].x;
      a.y += a.angular * before.l_m * cosine[i - 1] + centripetal[i].y;
    }
    ddq[i] = (u[i] - (U[i].angular * a.angular + U[i].x * a.x + U[i].y * a.y)) / D[i];
    a.angular += ddq[i];
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
  const Joints k1_dq = dq_rad_s;
  const Joints k1_ddq = Acceleration(q_rad, k1_dq, tau_Nm);
  const Joints k2_dq = ahead(dq_rad_s, k1_ddq, half);
  const Joints k2_ddq = Acceleration(ahead(q_rad, k1_dq, half), k2_dq, tau_Nm);
  const Joints k3_dq = ahead(dq_rad_s, k2_ddq, half);
  const Joints k3_ddq = Acceleration(ahead(q_rad, k2_dq, half), k3_dq, tau_Nm);
  const Joints k4_dq = ahead(dq_rad_s, k3_ddq, dt_s);
  const Joints k4_ddq = Acceleration(ahead(q_rad, k3_dq, dt_s), k4_dq, tau_Nm);
  for (size_t i = 0; i < n; ++i) {
    q_rad[i] += dt_s / 6.0 * (k1_dq[i] + 2.0 * k2_dq[i] + 2.0 * k3_dq[i] + k4_dq[i]);
    dq_rad_s[i] += dt_s / 6.0 * (k1_ddq[i] + 2.0 * k2_ddq[i] + 2.0 * k3_ddq[i] + k4_ddq[i]);
  }
}

PlanarPlant::Tip PlanarPlant::EndEffector() const {
  Tip tip{{config_.base_x_m, config_.base_y_m}, {0.0, 0.0}};
  double angle = config_.base_orientation_rad;
  double omega = 0.0;
  for (size_t i = 0; i < static_cast<size_t>(config_.dof); ++i) {
    angle += q_rad[i];
    omega += dq_rad_s[i];
    const double x = config_.links[i].l_m * std::cos(angle);
    const double y = config_.links[i].l_m * std::sin(angle);
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
