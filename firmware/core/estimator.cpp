#include "firmware/core/estimator.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

double Sign(double value) {
  return static_cast<double>((value > 0.0) - (value < 0.0));
}

// One block (x, v or a) of (1.9), explicit: a step of h beta against the sign of the disagreement.
void ExplicitStep(const TaskVector& mean, double h_beta, TaskVector& state, bool& in_band) {
  for (Eigen::Index c = 0; c < state.size(); ++c) {
    const double disagreement = state[c] - mean[c];
    // Explicit sgn chatters by one step around the mean, so its band is two steps wide.
    if (std::abs(disagreement) > 2.0 * h_beta) in_band = false;
    state[c] -= h_beta * Sign(disagreement);
  }
}

// The same with the sgn evaluated at the end of the step, solved in closed form: f moves to the mean, or by h
// beta.
void ImplicitStep(const TaskVector& f, const TaskVector& mean, double h_beta, TaskVector& state,
                  bool& in_band) {
  for (Eigen::Index c = 0; c < state.size(); ++c) {
    const double distance = f[c] - mean[c];
    const double beyond = std::abs(distance) - h_beta;
    // Equality up to rounding is inside: a slope of exactly beta must not flicker.
    if (beyond > 1e-7 * h_beta) in_band = false;
    state[c] = mean[c] + Sign(distance) * std::max(0.0, beyond);
  }
}

}  // namespace

Estimator::Estimator(const EstimatorConfig& config, const Zeta& initial) : config_(config), zeta_(initial) {
  if (config_.leaderless) {
    // The arms agree on a point. An agreed velocity would make that point drift without an agreed clock.
    zeta_.v_m_s.setZero();
    zeta_.a_m_s2.setZero();
  }
}

void Estimator::Update(const Neighbours& neighbours, double h_s) {
  const bool predict = config_.kind == EstimatorKind::kPredictive;
  const Eigen::Index m = zeta_.x_m.size();
  const Zeta f = predict ? Taylor(zeta_, h_s) : zeta_;

  // Weighted mean of what was heard. Without a leader a node is one of its own neighbours: averaging over the
  // others alone only passes values around a ring.
  Zeta mean = config_.leaderless ? f : Zeta::Zero(m);
  double degree = config_.leaderless ? 1.0 : 0.0;
  for (int j = 0; j < neighbours.count; ++j) {
    const Neighbour& neighbour = neighbours.list[static_cast<size_t>(j)];
    if (!neighbour.heard || neighbour.weight <= 0.0) continue;
    const Zeta z_j = predict ? Taylor(neighbour.zeta, neighbour.age_s + h_s) : neighbour.zeta;
    mean.x_m += neighbour.weight * z_j.x_m;
    mean.v_m_s += neighbour.weight * z_j.v_m_s;
    mean.a_m_s2 += neighbour.weight * z_j.a_m_s2;
    degree += neighbour.weight;
  }

  if (degree <= 0.0) {  // nobody heard: coast on the own prediction, which is an estimate of nothing
    zeta_ = f;
    in_band_ = false;
  } else {
    mean.x_m /= degree;
    mean.v_m_s /= degree;
    mean.a_m_s2 /= degree;
    in_band_ = true;
    if (config_.kind == EstimatorKind::kPaper) {
      ExplicitStep(mean.x_m, h_s * config_.beta_1_m_s, zeta_.x_m, in_band_);
      ExplicitStep(mean.v_m_s, h_s * config_.beta_2_m_s2, zeta_.v_m_s, in_band_);
      ExplicitStep(mean.a_m_s2, h_s * config_.beta_3_m_s3, zeta_.a_m_s2, in_band_);
    } else {
      ImplicitStep(f.x_m, mean.x_m, h_s * config_.beta_1_m_s, zeta_.x_m, in_band_);
      ImplicitStep(f.v_m_s, mean.v_m_s, h_s * config_.beta_2_m_s2, zeta_.v_m_s, in_band_);
      ImplicitStep(f.a_m_s2, mean.a_m_s2, h_s * config_.beta_3_m_s3, zeta_.a_m_s2, in_band_);
    }
  }
  UpdateAgreement(neighbours);
}

void Estimator::Coast(double ahead_s) {
  if (config_.kind == EstimatorKind::kPredictive) zeta_ = Taylor(zeta_, ahead_s);
}

void Estimator::UpdateAgreement(const Neighbours& neighbours) {
  if (in_band_) {
    int upstream = kMaxAgreement;
    for (int j = 0; j < neighbours.count; ++j) {
      const Neighbour& neighbour = neighbours.list[static_cast<size_t>(j)];
      if (neighbour.weight <= 0.0) continue;
      upstream = std::min(upstream, neighbour.heard ? neighbour.agreement : 0);
    }
    agreement_ = std::min({agreement_ + 1, upstream + 1, kMaxAgreement});
    ticks_out_of_band_ = 0;
    if (agreement_ >= config_.sync_ticks) synced_ = true;
  } else {
    agreement_ = 0;
    if (++ticks_out_of_band_ >= config_.desync_ticks) synced_ = false;
  }
}

}  // namespace armada
